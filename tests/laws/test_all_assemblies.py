"""Counts of assemblies against published numbers and polynomials, with their estimate."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from registry import CASES, model_of

import dalembert as da
from dalembert import planar, spatial
from dalembert.cli import main
from dalembert.model.graph.assembly.assemblies import Completeness
from dalembert.model.graph.assembly.many_roots import ManyRoots
from dalembert.model.graph.assembly.position_search import RandomStarts

# P. Dietmaier (1998): The Stewart-Gough platform of general geometry can have 40 real postures.
BASE = (
    (0, 0, 0),
    (1.107915, 0, 0),
    (0.549094, 0.756063, 0),
    (0.735077, -0.223935, 0.525991),
    (0.514188, -0.526063, -0.368418),
    (0.590473, 0.094733, -0.205018),
)
PLATE = (
    (0, 0, 0),
    (0.542805, 0, 0),
    (0.956919, -0.528915, 0),
    (0.665885, -0.353482, 1.402538),
    (0.478359, 1.158742, 0.107672),
    (-0.137087, -0.235121, 0.353913),
)
LEGS = (1.0, 0.645275, 1.086284, 1.503439, 1.281933, 0.771071)


def rotation_matrix(e: np.ndarray) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(np.roll(e, -1)).as_matrix()


@pytest.mark.thorough
def test_stewart_gough_platform_with_forty_assemblies():
    system = da.System("platform")
    inertia = {"mass": 1, "inertia": (1, 1, 1)}
    plate = system.add(spatial.Body("plate", position=(0.3, 0.2, 0.9), **inertia))
    for k in range(6):
        ends = system.ground.point(*BASE[k]), plate.point(*PLATE[k])
        system.add(planar.DistanceDriver(f"leg{k}", *ends, LEGS[k]))
    model = system.build()
    assemblies = da.solve_assembly(model, all=True)
    assert len(assemblies) == 40 and assemblies.completeness.missing < 0.5
    for one in assemblies:
        reached = one.y[:3] + PLATE @ rotation_matrix(one.y[3:7]).T - BASE
        np.testing.assert_allclose(np.linalg.norm(reached, axis=1), LEGS, atol=1e-10)
    poses = [np.concatenate([one.y[:3], rotation_matrix(one.y[3:7]).ravel()]) for one in assemblies]
    apart = np.abs(np.array(poses)[:, None] - poses).max(axis=2)
    assert apart[np.triu_indices(40, 1)].min() > 1e-3
    far = [np.linalg.norm(assemblies[0].y[:3] - one.y[:3]) for one in assemblies]
    assert far[0] == 0.0 and min(far[1:]) > 0.0


# Base and platform of a planar 3-RPR mechanism
GROUND = np.array([(0.0, 0.0), (1.2, -1.4), (-2.1, 2.2)])
TRIANGLE = np.array([(0.0, 0.0), (-2.9, 2.7), (0.3, 1.0)])


def turned(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([(c, -s), (s, c)])


def assemblies_by_elimination(lengths: np.ndarray) -> int:
    """Real roots of the sextic in e^{iφ}: the place follows from two differences, linear in it."""

    def resultant(angle: float) -> float:
        d = TRIANGLE @ turned(angle).T - GROUND
        matrix = 2 * (d[1:] - d[0])
        right = lengths[1:] ** 2 - lengths[0] ** 2 - np.sum(d[1:] ** 2, axis=1) + d[0] @ d[0]
        det = np.linalg.det(matrix)
        place = np.array(
            [
                right[0] * matrix[1, 1] - right[1] * matrix[0, 1],
                right[1] * matrix[0, 0] - right[0] * matrix[1, 0],
            ]
        )
        leg = place + det * d[0]
        return leg @ leg - (lengths[0] * det) ** 2

    series = np.fft.fft([resultant(2 * np.pi * k / 16) for k in range(16)])
    coefficients = np.concatenate([series[-6:], series[:7]])
    nonzero = np.flatnonzero(np.abs(coefficients) > 1e-11 * np.abs(coefficients).max())
    roots = np.roots(coefficients[nonzero[0] : nonzero[-1] + 1][::-1])
    return int(np.sum(np.abs(np.abs(roots) - 1) < 1e-6))


def three_legs(place, angle, ground=GROUND, triangle=TRIANGLE) -> da.Model:
    system = da.System("3-RPR")
    plate = system.add(planar.Body("plate", mass=1, inertia=1, position=place, angle=angle))
    start = np.linalg.norm(place + triangle @ turned(angle).T - ground, axis=1)
    for k in range(3):
        length = system.parameter(f"l{k}", start[k], "m")
        ends = system.ground.point(*ground[k]), plate.point(*triangle[k])
        system.add(planar.RigidLink(f"leg{k}", *ends, length=length))
    return system.build()


def scan(count: int, seed: int = 0) -> list[tuple[int, int]]:
    """(by elimination, by search) for random lengths at which there are assemblies."""
    rng, pairs = np.random.default_rng(seed), []
    model = three_legs((0.80931347, -0.97443812), -0.86068444)
    for _ in range(count):
        place, angle = np.add((0.8, -1.0), rng.uniform(-1, 1, 2)), rng.uniform(-np.pi, np.pi)
        lengths = np.linalg.norm(place + TRIANGLE @ turned(angle).T - GROUND, axis=1)
        values = {f"l{k}": float(lengths[k]) for k in range(3)}
        assemblies = da.solve_assembly(model, values, all=True)
        pairs.append((assemblies_by_elimination(lengths), len(assemblies)))
    return pairs


@pytest.mark.thorough
def test_planar_platforms_have_as_many_assemblies_as_their_polynomial():
    """Also where the branch of the nominal assembly ends before the lengths."""
    pairs = scan(12, seed=3)
    assert [computed for _, computed in pairs] == [expected for expected, _ in pairs]
    assert {expected for expected, _ in pairs} == {2, 4, 6}


# R. Manocha, J. Canny (1994), after C. Wampler, A. Morgan (1991): 6R with 16 inverse positions
DH = ((0.3, 0, 90), (1, 0, 1), (0, 0.2, 90), (1.5, 0, 1), (0, 0, 90), (0, 0, 1))
HAND = np.array(
    [
        (-0.760117, -0.641689, 0.102262, -1.140175),
        (0.133333, 0, 0.991071, 0),
        (-0.635959, 0.766965, 0.085558, 0),
        (0, 0, 0, 1),
    ]
)


def link(angle: float, a: float, d: float, alpha: float) -> np.ndarray:
    c, s, ca, sa = np.cos(angle), np.sin(angle), np.cos(alpha), np.sin(alpha)
    rows = [(c, -s * ca, s * sa, a * c), (s, c * ca, -c * sa, a * s), (0, sa, ca, d), (0, 0, 0, 1)]
    return np.array(rows)


@pytest.mark.thorough
def test_closed_chain_of_six_hinges_has_sixteen_assemblies():
    """From guesses with all angles zero, which are far from closed."""
    system = da.System("6R")
    rotation, _, last = np.linalg.svd(HAND[:3, :3])
    frames = [np.eye(4)]
    for a, d, alpha in DH[:5]:
        frames.append(frames[-1] @ link(0.0, a, d, np.radians(alpha)))
    solids = [system.ground]
    for k, frame in enumerate(frames[1:]):
        body = spatial.Body(
            f"b{k}", mass=1, inertia=(1, 1, 1), position=frame[:3, 3], rotation=frame[:3, :3]
        )
        solids.append(system.add(body))
    for k, (a, d, alpha) in enumerate(DH):
        near = solids[k].frame((0, 0, 0), axis=(0, 0, 1))
        back = np.linalg.inv(link(0.0, a, d, np.radians(alpha)))  # the joint seen from the far link
        if k == 5:  # the hand is held at its pose
            held = np.eye(4)
            held[:3, :3], held[:3, 3] = rotation @ last, HAND[:3, 3]
            back = held @ back
        far = solids[k + 1] if k < 5 else system.ground
        end = far.frame(tuple(back[:3, 3]), axis=tuple(back[:3, 2]))
        system.add(spatial.Revolute(f"J{k}", near, end))
    model = system.build()
    assemblies = da.solve_assembly(model, all=True)
    assert len(assemblies) == 16 and assemblies.completeness.missing < 0.5
    for one, other in pairwise(assemblies):
        assert np.abs(one.y - other.y).max() > 1e-3


def test_families_of_assemblies_are_counted_apart():
    """``x y = 0`` and ``x (x − 1) = 0``: the point (1, 0), and all of the line x = 0."""
    system = da.System("family")
    bead = system.add(planar.Particle("bead", mass=1.0, position=(0.9, 0.1)))
    system.add(planar.UserConstraint("first", bead.x * bead.y))
    system.add(planar.UserConstraint("second", bead.x * (bead.x - 1)))
    assemblies = da.solve_assembly(system.build(), all=True)
    assert len(assemblies) == 1 and assemblies.completeness.not_isolated > 100
    assert "continuous families" in str(assemblies)


@pytest.mark.parametrize("name", list(CASES)[::8])
def test_many_positions_are_evaluated_as_one_is(name):
    """Residuals and Jacobians of the square system, side by side and alone; its root is a root."""
    model = model_of(name)
    closure, p = model.closure, model.nominal
    pinned = closure.pinned.at(0.0, p)
    rng = np.random.default_rng(0)
    starts = RandomStarts(model.parts, model.all_equations, model.guesses, model.start.y, p)
    y = starts.draw(8, rng, 0.1)
    roots = ManyRoots(closure.assembler, 0.0, p, closure.pinned)
    value, zero, jacobian = roots.evaluate(y)
    step = -np.linalg.solve(jacobian, value[:, :, None])[:, :, 0] * closure.scales.displacements
    for k in range(len(y)):
        one = pinned.residual(y[k])
        np.testing.assert_allclose(value[k], one.value / one.scale, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(zero[k], one.zero(1e-14) / one.scale, rtol=1e-6)
        np.testing.assert_allclose(step[k], pinned.step(y[k], one), rtol=1e-5, atol=1e-9)
    assert roots.newton(model.start.y[None]).closed.all()


def test_estimate_of_what_is_missing():
    """A. Chao (1984): f₁ = 6, f₂ = 2 leave 6·5/(2·3) = 5; the bound solves (1 − q)ⁿ = .05."""
    completeness = Completeness(100, (1, 1, 1, 1, 1, 1, 2, 2, 30), 0, "")
    assert completeness.missing == 5.0
    assert (1 - completeness.undetected_share) ** sum(completeness.hits) == pytest.approx(0.05)


def test_command_line_lists_assemblies(tmp_path, capsys):
    import json
    from pathlib import Path

    file = Path(__file__).parents[2] / "examples/four_bar.toml"
    assert main(["check", str(file), "--assemblies", "--json"]) == 0
    output = json.loads(capsys.readouterr().out)["assemblies"]
    assert output["count"] == 2 and output["completeness"]["missing"] == 0.0
    assert (
        len(output["assemblies"]) == 2 and "crank.angle" in output["assemblies"][0]["coordinates"]
    )


@pytest.mark.parametrize("wrong", [{"count": 0}, {"count": "two"}, {"time": float("nan")}])
def test_options_of_the_search_are_checked(wrong):
    (name,) = wrong
    with pytest.raises(da.AnalysisError, match=f"{name} = .*: give a"):
        da.solve_assembly(three_legs((0.1, 0.2), 0.3), all=True, **wrong)
