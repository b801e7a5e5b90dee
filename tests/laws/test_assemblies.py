"""All ways in which a mechanism closes."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial

LEGS = {"one": ((0, 0), (0, 0), 5.0), "two": ((5, 0), (3, 0), 5.0), "three": ((0, 6), (3, 3), 3.0)}
ANGLES = (-0.7208492045, -0.3310051843, 1.1436855178, 2.1159090141)
PLACES = (
    (-1.3783796, 4.8062532),
    (-0.9147087, 4.9156188),
    (4.4817501, 2.2167355),
    (4.5718302, 2.0244428),
)


def platform() -> da.Model:
    """Planar platform on three legs (T. Sauer, *Numerical Analysis*, reality check 1)."""
    system = da.System("platform")
    plate = system.add(planar.Body("plate", mass=1, inertia=1, position=(4.5, 2.2), angle=1.1))
    for name, (base, place, length) in LEGS.items():
        ends = system.ground.point(*base), plate.point(*place)
        system.add(planar.RigidLink(name, *ends, length=length))
    return system.build()


def test_platform_closes_in_four_ways():
    """Angles and places to the ten and eight digits of an independent computation."""
    assemblies = da.solve_assembly(platform(), all=True, count=4)
    turns = [np.remainder(one.y[2] + np.pi, 2 * np.pi) - np.pi for one in assemblies]
    order = np.argsort(turns)
    np.testing.assert_allclose(np.sort(turns), ANGLES, atol=1e-9)
    np.testing.assert_allclose([assemblies[k].y[:2] for k in order], PLACES, atol=1e-7)
    assert max(one.residual for one in assemblies) < 1e-10
    np.testing.assert_array_equal(assemblies[0].y, da.solve_assembly(platform()).y)


def four_bar(rocker: float) -> da.Model:
    return four_bar_system(rocker).build()


def four_bar_system(rocker: float) -> da.System:
    system = da.System("four-bar")
    crank = system.add(planar.Bar("crank", length=0.3, mass=1, angle=1.0))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=1, angle=0.1))
    swing = system.add(planar.Bar("rocker", length=rocker, mass=1, angle=1.4))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, swing.end))
    system.add(planar.Revolute("C", system.ground.point(1, 0), swing.start))
    return system


def test_held_crank_leaves_an_open_and_a_crossed_four_bar():
    """Mirror images on the line from the crank pin to the fixed pin; whole turns do not count."""
    one, other = da.solve_assembly(four_bar(0.6), all=True)
    assert one.y[2] == other.y[2] == 1.0  # the crank's angle is held
    pin, pivot = 0.3 * np.exp(1j), 1.0 + 0.0j
    ends = [
        pivot + 0.6 * np.exp(1j * assembly.pose("rocker")["angle"]) for assembly in (one, other)
    ]
    line = (pivot - pin) / abs(pivot - pin)
    mirrored = pin + line**2 * np.conj(ends[0] - pin)
    np.testing.assert_allclose(mirrored, ends[1], atol=1e-12)


def test_whole_turns_do_not_count_beside_a_body_in_space():
    """The four-bar closes in two ways, whatever is welded to the ground next to it."""
    system = four_bar_system(0.6)
    box = system.add(spatial.Body("box", mass=1, inertia=(1, 1, 1), position=(0, 0, 1)))
    system.add(spatial.Weld("W", system.ground.frame((0, 0, 1)), box.frame((0, 0, 0))))
    assert len(da.solve_assembly(system.build(), all=True)) == 2


@pytest.mark.thorough
def test_parallel_hinges_of_a_link_are_not_turned_upside_down():
    """A rod on a ball and a link with parallel hinges: an open and a crossed four-bar."""
    system, axis = da.System("link"), (0, 0, 1)
    ground, still = system.ground, da.rotation.identity()
    crank = system.add(spatial.Body("crank", mass=1, inertia=(1, 1, 1), rotation=still))
    swing = system.add(spatial.Body("rocker", mass=1, inertia=(1, 1, 1)))
    hinge = ground.frame((0, 0, 0), axis=axis), crank.frame((0, 0, 0), axis=axis)
    system.add(spatial.Revolute("O", *hinge))
    system.add(spatial.Spherical("C", ground.point(1, 0, 0), swing.point(0, 0, 0)))
    pin, end = crank.frame((0.3, 0, 0), axis=axis), swing.frame((0.6, 0, 0), axis=axis)
    system.add(spatial.RevoluteRevoluteLink("coupler", pin, end, length=1.0))
    assemblies = da.solve_assembly(system.build(), all=True)
    assert len(assemblies) == 2
    for one in assemblies:
        np.testing.assert_allclose(rotation_of(one.y[10:14])[:, 2], axis, atol=1e-9)


def hexapod() -> tuple[da.Model, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    base, top = (
        np.column_stack([r * np.cos(a), r * np.sin(a), 0.1 * rng.uniform(size=6)])
        for r, a in ((1.0, [0, 0.4, 2.1, 2.5, 4.2, 4.6]), (0.6, [-0.5, 0.9, 1.6, 3.0, 3.7, 5.1]))
    )
    system = da.System("hexapod")
    place = np.array([0.1, 0.05, 1.0])
    plate = system.add(spatial.Body("plate", mass=1, inertia=(1, 1, 1), position=place))
    lengths = np.linalg.norm(place + top - base, axis=1)
    for k in range(6):
        ends = system.ground.point(*base[k]), plate.point(*top[k])
        system.add(planar.DistanceDriver(f"leg{k}", *ends, lengths[k]))
    return system.build(), base, top, lengths


def test_hexapod_closes_in_several_ways_each_of_which_closes():
    model, base, top, lengths = hexapod()
    assemblies = da.solve_assembly(model, all=True, count=4)
    assert len(assemblies) == 4
    for one in assemblies:
        turned = rotation_of(one.y[3:7])
        reached = np.linalg.norm(one.y[:3] + top @ turned.T - base, axis=1)
        np.testing.assert_allclose(reached, lengths, atol=1e-10)
    places = np.array([one.y[:3] for one in assemblies])
    apart = np.linalg.norm(places[:, None] - places[None], axis=2)
    assert apart[np.triu_indices(4, 1)].min() > 1e-3


def rotation_of(e: np.ndarray) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(np.roll(e, -1)).as_matrix()


def test_hinges_are_not_turned_upside_down():
    """The same four-bar in space, of hinges and a ball joint: two ways, none by flipped hinges."""
    system, axis = da.System("hinges"), (0, 0, 1)
    ground, still = system.ground, da.rotation.identity()
    crank = system.add(spatial.Body("crank", mass=1, inertia=(1, 1, 1), rotation=still))
    coupler, swing = (
        system.add(spatial.Body(name, mass=1, inertia=(1, 1, 1))) for name in ("coupler", "rocker")
    )
    joints = (
        ("O", ground.frame((0, 0, 0), axis=axis), crank.frame((0, 0, 0), axis=axis)),
        ("A", crank.frame((0.3, 0, 0), axis=axis), coupler.frame((0, 0, 0), axis=axis)),
        ("C", ground.frame((1, 0, 0), axis=axis), swing.frame((0, 0, 0), axis=axis)),
    )
    for name, first, second in joints:
        system.add(spatial.Revolute(name, first, second))
    system.add(spatial.Spherical("B", coupler.point(1, 0, 0), swing.point(0.6, 0, 0)))
    model = system.build()
    assemblies = da.solve_assembly(model, all=True)
    assert len(assemblies) == 2
    for one in assemblies:
        for k in range(3):
            turned = rotation_of(one.y[7 * k + 3 : 7 * k + 7])
            np.testing.assert_allclose(turned[:, 2], axis, atol=1e-9)


def test_the_same_seed_finds_the_same_order():
    one, other = (da.solve_assembly(four_bar(0.6), all=True, count=2, rng=7) for _ in range(2))
    np.testing.assert_array_equal([a.y for a in one], [a.y for a in other])


def test_no_other_way():
    """A pendulum whose angle is given closes in one way only."""
    system = da.System("pendulum")
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0, angle=0.3))
    system.add(planar.Revolute("pin", system.ground.center, bar.start))
    assert len(da.solve_assembly(system.build(), all=True)) == 1


@pytest.mark.parametrize("shift", [0.0, 0.4])
def test_speeds_come_along(shift):
    """Each assembly has speeds of its own, consistent with its joints."""
    model = four_bar(0.6 + shift)
    for one in da.solve_assembly(model, all=True, count=2):
        e = model.all_equations
        import casadi as ca

        psi = ca.Function("psi", [e.t, e.y, e.v, e.p], [e.velocity_constraints])
        np.testing.assert_allclose(psi(0, one.y, one.v, model.nominal), 0.0, atol=1e-12)


def test_a_run_that_changes_branch_says_so():
    """Steps whose end is put into the other assembly, with its speeds; without that, silence."""
    from dataclasses import replace

    from dalembert.analysis.dynamics.step_length_checks import BranchJumps

    model = four_bar(0.6)
    motion = da.solve_dynamics(model, 0.1, step=0.01, stabilization=da.Projection())
    record = motion.record
    assert BranchJumps(record.kernel, record.steps).warnings == []
    _, other = da.solve_assembly(model, all=True, count=2)
    x = np.array(record.steps.x)
    x[:9, 6:], x[9:18, 6:] = other.y[:, None], other.v[:, None]
    (warnings,) = BranchJumps(record.kernel, replace(record.steps, x=x)).warnings
    assert warnings.startswith("at t = 0.05 s rocker.angle jumps by")
    assert "another assembly" in warnings
