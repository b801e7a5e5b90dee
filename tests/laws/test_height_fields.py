"""Height fields: clearances by convex programs, slopes, bowls, bumps, files, errors."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import LinearConstraint, NonlinearConstraint, minimize
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import spatial
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.errors import ModelError
from dalembert.io import load
from tests.laws.test_cylinders import SHAPES, core, cylinder
from tests.registry.gap_derivatives import GapDerivatives

G = 9.81
contact = spatial.contact
GRID = np.linspace(-0.3, 0.3, 4)
BUMPS = 0.06 * np.random.default_rng(1).normal(size=(4, 4))


# clearance ------------------------------------------------------------------------------------
def clearance(name: str, turn: np.ndarray) -> float:
    """Smallest vertical distance of a body at the origin from the bumps, triangle by triangle."""
    smallest = np.inf
    for i in range(3):
        for j in range(3):
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            places = np.array([(GRID[a], GRID[b], BUMPS[a, b]) for a, b in corners])
            for chosen in ((0, 1, 2), (0, 2, 3)):
                smallest = min(smallest, over_triangle(name, turn, places[list(chosen)]))
    return smallest


def over_triangle(name: str, turn: np.ndarray, triangle: np.ndarray) -> float:
    """Smallest height over the plane of a triangle of points of the body above the triangle.

    A point of the body is ``R (s + w)``, with ``s`` in the core and ``|w|`` at most the rounding.
    """
    planes, limits, matrix, radius, rounding = core(name)
    normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
    normal /= normal[2]
    sides = np.roll(triangle, -1, axis=0) - triangle
    inward = np.column_stack([-sides[:, 1], sides[:, 0], 0 * sides[:, 0]])
    both = np.hstack([turn, turn])
    constraints = [LinearConstraint(inward @ both, (inward * triangle).sum(axis=1), np.inf)]
    if len(planes):
        padded = np.hstack([planes, np.zeros_like(planes)])
        constraints.append(LinearConstraint(padded, -np.inf, limits))
    for part, m, r in ((0, matrix, radius), (3, np.eye(3), rounding)):
        constraints.append(
            NonlinearConstraint(
                lambda x, p=part, m=m: x[p : p + 3] @ m @ x[p : p + 3],
                -np.inf,
                r**2,
                jac=lambda x, p=part, m=m: np.hstack(
                    [2 * m @ x[p : p + 3] if q == p else np.zeros(3) for q in (0, 3)]
                ),
            )
        )
    if not rounding:
        constraints.pop()
        constraints.append(LinearConstraint(np.eye(6)[3:], 0, 0))
    slope = normal @ both
    best = minimize(
        lambda x: slope @ x,
        np.zeros(6),
        jac=lambda x: slope,
        method="SLSQP",
        constraints=constraints,
        options={"ftol": 1e-12, "maxiter": 300},
    )
    if best.status != 0 or best.x @ best.x > 1:  # not above the triangle
        return np.inf
    return float(best.fun - normal @ triangle[0])


@pytest.mark.thorough
@pytest.mark.parametrize("name", SHAPES)
def test_gaps_close_where_bodies_touch(name):
    """Bodies lifted by their clearance and a little more do not touch, a little less they do."""
    model, rng = on_bumps(name), np.random.default_rng(7)
    source, width = gap_sources(model)[-1], 1e-4
    travels = np.full((model.equations.speed_count, 1), 0.005)
    for _ in range(5):
        turn = Rotation.random(random_state=rng.integers(1 << 30))
        lift = -clearance(name, turn.as_matrix())
        smallest = []
        for above in (width, -width):
            y = np.hstack([0, 0, lift + above, turn.as_quat(scalar_first=True), model.start.y[7:]])
            gaps = source.near(Configuration(0.0, y, model.nominal), travels)
            smallest.append(gaps.distance.min())
        assert 0 < smallest[0] <= 1.0001 * width
        assert -1.0001 * width <= smallest[1] < 0


def on_bumps(name: str, tilted: bool = False) -> da.Model:
    """A body of one shape over the bumps, which may belong to another body."""
    system = da.System("bumps")
    bodies = [system.add(spatial.Body(n, mass=1.0, inertia=(1.0, 1.0, 1.0))) for n in "bg"]
    frame = bodies[1].frame((0.1, 0, 0), axis=(0, 0.6, 0.8)) if tilted else system.ground.frame()
    ground = contact.HeightField(frame, (0.6, 0.6), BUMPS)
    system.add(spatial.Collisions("touch", [SHAPES[name](bodies[0]), ground]))
    if not tilted:
        system.add(spatial.Weld("fixed", system.ground, bodies[1]))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("name", SHAPES)
def test_velocities_of_gaps_are_rates_of_distances_and_formulas_are_the_numbers(name):
    model = on_bumps(name, tilted=True)
    e, p, source, rng = (
        model.equations,
        model.nominal,
        gap_sources(model)[-1],
        np.random.default_rng(2),
    )
    travels, count = np.full((e.speed_count, 1), 0.1), 0
    another = np.random.default_rng(3)
    for _ in range(4):
        turns = [Rotation.random(random_state=rng.integers(1 << 30)) for _ in range(2)]
        place = turns[1].apply([0.1, -0.6 * 0.12, 0.8 * 0.12])
        parameters = [turn.as_quat(scalar_first=True) for turn in turns]
        y, v = (
            np.hstack([place, parameters[0], 0, 0, 0, parameters[1]]),
            rng.normal(size=e.speed_count),
        )
        gaps = source.near(Configuration(0.0, y, p), travels)
        ends = [
            source.near(Configuration(0.0, e.manifold.go(y, s * v), p), travels)
            for s in (1e-6, -1e-6)
        ]
        distances = [dict(zip(end.key, end.distance, strict=True)) for end in ends]
        for k, key in enumerate(gaps.key):
            if not all(key in distance for distance in distances):
                continue
            count += 1
            rate = (distances[0][key] - distances[1][key]) / 2e-6
            assert rate == pytest.approx(gaps.speeds(v)[k, 0], abs=1e-6)
        formulas = GapDerivatives(source, model, v, another.normal(size=v.size))
        formulas.check_values(y, gaps)
        formulas.check_slopes(y, gaps, another)
    assert count >= 4


# motions --------------------------------------------------------------------------------------
SLOPE = 0.3
UPHILL = da.rotation.axis_angle((0, 1, 0), SLOPE)
ACROSS = da.rotation.axis_angle((1, 0, 0), np.pi / 2)
ON_SLOPE = {
    "ball": (lambda b: contact.Sphere(b.center, 0.1), 0.1, 5 / 7, np.eye(3)),
    "cylinder": (lambda b: cylinder(b, 0.1, 0.25), 0.1, 2 / 3, ACROSS),
    "box": (lambda b: contact.Box(b.center, (0.2, 0.15, 0.1)), 0.05, None, UPHILL),
    "disc": (lambda b: cylinder(b, 0.1, 0.04), 0.02, None, UPHILL),
}
"""Shape, height of the middle, fraction of the acceleration of a rolling body, orientation."""


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ON_SLOPE)
def test_a_slope_of_triangles_is_an_inclined_plane(name):
    """Bodies cross the edges of cells without a jolt."""
    build, height, rolling, rotation = ON_SLOPE[name]
    system = da.System("slope", gravity=(0.0, 0.0, -G))
    normal = np.array([np.sin(SLOPE), 0, np.cos(SLOPE)])
    start = np.array([-0.2, 0.013, 0.2 * np.tan(SLOPE)])
    inertia = 0.4 * 0.1**2 if name == "ball" else 0.5 * 0.1**2
    body = spatial.Body(
        "b",
        mass=1.0,
        inertia=(inertia,) * 3,
        position=tuple(start + height * normal),
        rotation=rotation,
    )
    shape = build(system.add(body))
    heights = np.outer(np.linspace(0.5, -0.5, 23) * np.tan(SLOPE), np.ones(11))
    ground = contact.HeightField(system.ground.frame(), (1.0, 1.0), heights)
    system.add(spatial.Collisions("touch", [shape, ground], friction=0.5 if rolling else 0.2))
    motion = da.solve_nonsmooth(system.build(), 0.2, step=2e-3)
    sliding = G * (np.sin(SLOPE) - 0.2 * np.cos(SLOPE))
    expected = rolling * G * np.sin(SLOPE) if rolling else sliding
    assert motion.status.success
    assert motion["b.vx"][-1] == pytest.approx(expected * np.cos(SLOPE) * 0.2, abs=1e-9)
    assert motion["b.x"][-1] == pytest.approx(
        -0.2 + height * normal[0] + expected * np.cos(SLOPE) * 0.02, abs=1e-9
    )


@pytest.mark.thorough
def test_a_ball_oscillates_in_a_bowl():
    """Without friction, its centre moves on a curve parallel to the parabola ``z = x²/(2 R)``."""
    curvature, radius, foot = 0.5, 0.05, 0.1

    def place(x: float) -> tuple[float, float, float]:
        """Centre and speed along the curve for a foot at x, by its rate."""
        root = np.sqrt(1 + (x / curvature) ** 2)
        center = x - radius * x / curvature / root, x**2 / 2 / curvature + radius / root
        return *center, root - radius / curvature / root**2

    top = place(foot)[1]

    def slowness(phase: float) -> float:
        x = foot * np.sin(phase)
        _, height, rate = place(x)
        return rate * foot * np.cos(phase) / np.sqrt(2 * G * (top - height))

    period = 4 * quad(slowness, 0, np.pi / 2 - 1e-9)[0]
    errors = []
    for count in (41, 81):
        grid = np.linspace(-0.2, 0.2, count)
        heights = (grid[:, None] ** 2 + grid**2) / 2 / curvature
        system = da.System("bowl", gravity=(0.0, 0.0, -G))
        x, z, _ = place(foot)
        ball = spatial.Sphere("b", radius=radius, mass=1.0, position=(x, 0, z + 1e-4))
        bowl = contact.HeightField(system.ground.frame(), (0.4, 0.4), heights)
        shapes = [contact.Sphere(system.add(ball).center, radius), bowl]
        system.add(spatial.Collisions("touch", shapes))
        motion = da.solve_nonsmooth(system.build(), 0.53 * period, step=4e-3)
        assert motion.status.success
        across, times = motion["b.vx"].values, motion.time
        turn = np.flatnonzero((across[:-1] < 0) & (across[1:] >= 0))[-1]
        errors.append(abs(2 * times[turn] / period - 1))
    assert errors[0] < 0.03 and errors[1] < 0.01


@pytest.mark.thorough
def test_bodies_on_bumps_neither_sink_nor_gain_energy():
    rng, system = np.random.default_rng(3), da.System("bumps", gravity=(0.0, 0.0, -G))
    grid = np.linspace(-0.5, 0.5, 15)
    heights = (
        0.03 * np.sin(12 * grid)[:, None] * np.cos(9 * grid)
        + 0.5 * grid**2
        + 0.5 * grid[:, None] ** 2
    )
    shapes = [contact.HeightField(system.ground.frame(), (1.0, 1.0), heights)]
    for k, name in enumerate(SHAPES):
        body = spatial.Body(
            f"b{k}",
            mass=1.0,
            inertia=(3e-3,) * 3,
            position=(-0.2 + 0.4 * (k % 2), -0.2 + 0.2 * (k // 2), 0.25 + 0.2 * (k // 2)),
            rotation=da.rotation.axis_angle(tuple(rng.normal(size=3)), 1.0 + k),
            angular_velocity=tuple(2 * rng.normal(size=3)),
        )
        shapes.append(SHAPES[name](system.add(body)))
    system.add(spatial.Collisions("all", shapes, restitution=0.2, friction=0.4))
    motion = da.solve_nonsmooth(system.build(), 0.32, step=2e-3)
    energy = motion.data["energy"].values
    assert motion.status.success
    assert motion.data["penetration"].max() < 1e-9
    assert motion.statistics["maximum energy gained in contacts [J]"] <= 1e-10
    assert np.diff(energy).max() <= 1e-3 * energy[0]
    assert energy[-1] < energy[0]


# files and errors -----------------------------------------------------------------------------
FILE = """
format = 1
name = "hill"
gravity = [0, 0, -9.81]

[bodies.ball]
mass = 1
inertia = [0.004, 0.004, 0.004]
position = [0, 0, 0.1]

[forces.touch]
type = "Collisions"

[[forces.touch.shapes]]
type = "Sphere"
point = "ball"
radius = 0.1

[[forces.touch.shapes]]
type = "HeightField"
point = "ground"
size = [1, 1]
HEIGHTS
"""


@pytest.mark.parametrize(
    "given", ["heights = [[0, 0, 0], [0, 0, 0]]", 'file = "hill.csv"\nscale = 0.01']
)
def test_heights_in_files(tmp_path, given):
    (tmp_path / "hill.csv").write_text("0,0\n0,0\n0,0\n", encoding="utf-8")
    path = tmp_path / "model.toml"
    path.write_text(FILE.replace("HEIGHTS", given), encoding="utf-8")
    motion = da.solve_nonsmooth(load(path).build(), 0.05, step=5e-3)
    assert abs(motion["ball.z"] - 0.1).max() < 1e-12


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "give either heights or file"),
        ({"heights": [[0, 1]]}, r"the shape \(1, 2\); give at least 2 by 2"),
        ({"heights": [[0, 1], [1, np.nan]]}, "in row 2, column 2 is nan; give a finite number"),
        ({"heights": np.zeros((300, 300))}, "90000 heights and 40000 are allowed"),
        ({"heights": [[0, 1], [1]]}, "no rows of as many numbers"),
    ],
)
def test_bad_heights(options, message):
    with pytest.raises(ModelError, match=message):
        contact.HeightField(
            da.System("bad", gravity=(0, 0, -1)).ground.frame(), (1.0, 1.0), **options
        )


@pytest.mark.parametrize("name", ["box", "capsule", "drum"])
def test_bodies_beside_a_fence_do_not_touch_its_other_side(name):
    """A body at 0.2 m from a fence of 0.5 m height that leans by 0.2 stands apart from it."""
    for turn, axis in ((0.9, (1, 1, 1)), (0.6, (0, 1, 0)), (-1.2, (1, -1, 0)), (1.2, (1, 1, 1))):
        for place in ((0.28, 0.03, 0.35), (0.28, 0.03, 0.45)):
            system, heights = da.System("fence", gravity=(0, 0, 0)), np.zeros((21, 21))
            heights[10] = 0.5
            turned = da.rotation.axis_angle(axis, turn)
            start = {"position": place, "rotation": turned}
            body = system.add(spatial.Body("body", mass=1.0, inertia=(1e-2,) * 3, **start))
            ends = body.point(0, -0.1, 0), body.point(0, 0.1, 0)
            shape = {
                "box": contact.Box(body.center, (0.2, 0.2, 0.1)),
                "capsule": contact.Capsule(*ends, 0.05),
                "drum": contact.Cylinder(*ends, 0.05),
            }[name]
            fence = contact.HeightField(system.ground.frame(), (2.0, 2.0), heights)
            system.add(spatial.Collisions("touch", [shape, fence]))
            motion = da.solve_nonsmooth(system.build(), 2e-3, step=1e-3)
            assert motion.impulse("touch").sum() == 0.0


def test_a_ball_beside_a_peak_does_not_touch_its_far_side():
    """The planes of the far sides of a steep peak are above the ball."""
    heights = np.zeros((21, 21))
    heights[::4, ::4] = 2.0
    for place in ((2.112, 1.933, 1.434), (-0.068, 2.046, 1.642), (0.222, -2.171, 1.462)):
        system = da.System("peaks", gravity=(0, 0, 0))
        ball = system.add(spatial.Sphere("ball", radius=1.0, mass=1.0, position=place))
        peaks = contact.HeightField(system.ground.frame(), (10.0, 10.0), heights)
        system.add(spatial.Collisions("touch", [contact.Sphere(ball.center, 1.0), peaks]))
        motion = da.solve_nonsmooth(system.build(), 2e-3, step=1e-3)
        assert motion.impulse("touch").sum() == 0.0


# lines of the grid and the border -------------------------------------------------------------
@pytest.mark.parametrize("place", [(0.03, 0.02), (0.03, 0.0), (0.0, 0.0)])
def test_a_ball_over_a_line_of_a_flat_grid_presses_on_one_triangle(place):
    """``m g = K δ^(3/2)`` inside a triangle, over a line and over a vertex."""
    system = da.System("ball on a field", gravity=(0, 0, -G))
    ball = system.add(spatial.Sphere("ball", radius=0.05, mass=1.0, position=(*place, 0.05)))
    field = contact.HeightField(system.ground.frame(), (2, 2), np.zeros((21, 21)))
    law = contact.HuntCrossley(stiffness=1e6, damping=5.0)
    shapes = [contact.Sphere(ball.center, 0.05), field]
    system.add(spatial.Collisions("contacts", shapes, law=law))
    motion = da.solve_nonsmooth(system.build(), 0.4, step=1e-3)
    assert 0.05 - motion["ball.z"][-1].item() == pytest.approx((G / 1e6) ** (2 / 3), rel=1e-4)


def on_border(kind: str) -> tuple[da.Model, float]:
    """A body that covers a field of 2 m by 2 m, or reaches over its border; its height at rest."""
    system, middle = da.System("border", gravity=(0, 0, -G)), 0.013
    if kind == "capsule":
        turn = Rotation.from_rotvec([0, np.pi / 2, 0]).as_matrix()
        start = {"position": (0, middle, 0.052), "rotation": turn}
        body = system.add(spatial.Capsule("body", radius=0.05, length=3.0, mass=1.0, **start))
        ends = body.point(0, 0, -1.5), body.point(0, 0, 1.5)
        shape: spatial.contact.Shape = contact.Capsule(*ends, 0.05)
    elif kind == "cylinder":
        start = {"position": (0, middle, 0.052)}
        body = system.add(spatial.Cylinder("body", radius=1.6, length=0.1, mass=1.0, **start))
        shape = contact.Cylinder(body.point(0, 0, -0.05), body.point(0, 0, 0.05), 1.6)
    else:
        size = {"plate": (3, 3, 0.1), "strip": (3, 0.5, 0.1)}.get(kind, (0.5, 0.5, 0.1))
        place = {"edge": (0.9, middle), "corner": (-0.9, -0.87)}.get(kind, (0, middle))
        start = {"position": (*place, 0.052)}
        body = system.add(spatial.Box("body", size=size, mass=1.0, **start))
        shape = contact.Box(body.center, size)
    field = contact.HeightField(system.ground.frame(), (2, 2), np.zeros((11, 11)))
    system.add(spatial.Collisions("contacts", [shape, field], friction=0.5))
    return system.build(), 0.05


@pytest.mark.few(2)
@pytest.mark.parametrize("kind", ["plate", "edge", "capsule", "cylinder", "strip", "corner"])
def test_bodies_over_the_border_of_a_field_rest_on_it(kind):
    model, height = on_border(kind)
    motion = da.solve_nonsmooth(model, 0.3, step=2e-3)
    assert motion.status.success
    assert motion["body.z"][-1].item() == pytest.approx(height, abs=1e-9)
    assert np.abs(motion["body.angular_velocity"][-1]).max() < 1e-9
