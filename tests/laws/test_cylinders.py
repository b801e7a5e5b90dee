"""Cylinders: distances by convex programs, rolling, standing, toppling, stacks, wobbling discs."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import Bounds, LinearConstraint, NonlinearConstraint, minimize
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import spatial
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration

G = 9.81
contact = spatial.contact
LYING = da.rotation.axis_angle((1, 0, 0), np.pi / 2)


def cylinder(body: spatial.Body, radius: float, length: float) -> contact.Cylinder:
    """About the z axis of a body."""
    half = length / 2
    return contact.Cylinder(body.point(0, 0, -half), body.point(0, 0, half), radius)


# distances ------------------------------------------------------------------------------------
PYRAMID = np.array([(-1.5, -1, -1), (1.5, -1, -1), (1.5, 1, -1), (-1.5, 1, -1), (0.2, 0.1, 1.5)])
SHAPES = {
    "sphere": lambda b: contact.Sphere(b.center, 0.1),
    "capsule": lambda b: contact.Capsule(b.point(0, 0, -0.1), b.point(0, 0, 0.1), 0.06),
    "box": lambda b: contact.Box(b.center, (0.3, 0.2, 0.1)),
    "polyhedron": lambda b: contact.Polyhedron(b, PYRAMID.tolist(), scale=0.1),
    "cylinder": lambda b: cylinder(b, 0.09, 0.25),
    "disc": lambda b: cylinder(b, 0.15, 0.02),
}
ROUND = {"sphere", "capsule"}


def core(name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray, float, float]:
    """Half-spaces ``A x ≤ b``, matrix ``K`` with ``|K x| ≤ r``, and the rounding of a shape."""
    z, across, none = np.array([[0, 0, 1.0]]), np.diag([1.0, 1.0, 0]), np.zeros((0, 3))
    up_down = np.vstack([z, -z])
    if name == "sphere":
        return none, np.zeros(0), np.eye(3), 0.0, 0.1
    if name == "capsule":
        return up_down, np.full(2, 0.1), across, 0.0, 0.06
    if name == "box":
        return np.vstack([np.eye(3), -np.eye(3)]), np.array([3, 2, 1, 3, 2, 1]) / 20, across, 9.0, 0
    if name == "polyhedron":
        planes = ConvexHull(0.1 * PYRAMID).equations
        return planes[:, :3], -planes[:, 3], across, 9.0, 0.0
    radius, length = {"cylinder": (0.09, 0.25), "disc": (0.15, 0.02)}[name]
    return up_down, np.full(2, length / 2), across, radius, 0.0


def distance(names: tuple[str, str], poses: list[tuple[np.ndarray, np.ndarray]]) -> float:
    """The smallest distance of points of two shapes, a convex program."""
    rounding, constraints = 0.0, []
    turns = [turn for _, turn in poses]
    for k, name in enumerate(names):
        planes, limits, matrix, radius, own = core(name)
        part = slice(3 * k, 3 * k + 3)
        rounding += own
        if planes.size:
            table = np.zeros((len(planes), 6))
            table[:, part] = planes
            constraints.append(LinearConstraint(table, -np.inf, limits))
        constraints.append(
            NonlinearConstraint(
                lambda x, p=part, m=matrix: x[p] @ m @ x[p],
                -np.inf,
                radius**2,
                jac=lambda x, p=part, m=matrix: np.hstack(
                    [2 * m @ x[p] if q == p.start else np.zeros(3) for q in (0, 3)]
                ),
            )
        )

    def square(x: np.ndarray) -> tuple[float, np.ndarray]:
        between = poses[1][0] + turns[1] @ x[3:] - poses[0][0] - turns[0] @ x[:3]
        slope = np.concatenate([-2 * turns[0].T @ between, 2 * turns[1].T @ between])
        return 10 * float(between @ between), 10 * slope

    best = minimize(
        square,
        np.zeros(6),
        jac=True,
        method="SLSQP",
        bounds=Bounds(-1, 1),
        constraints=constraints,
        options={"ftol": 1e-15, "maxiter": 500},
    )
    return float(np.sqrt(best.fun / 10)) - rounding


def model_of(names: tuple[str, str]) -> da.Model:
    system = da.System("pair")
    bodies = [
        system.add(spatial.Body(k, mass=1.0, inertia=(1.0, 1.0, 1.0), position=(p, 0, 0)))
        for k, p in (("a", 0.0), ("b", 9.0))
    ]
    shapes = [SHAPES[name](body) for name, body in zip(names, bodies, strict=True)]
    system.add(spatial.Collisions("touch", shapes))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("first", ["cylinder", "disc"])
@pytest.mark.parametrize("second", SHAPES)
def test_distances_are_those_of_a_convex_program(first, second):
    """Sharp edges beside each other: a lower bound."""
    names, rng, exact = (first, second), np.random.default_rng(5), 0
    model = model_of(names)
    source = gap_sources(model)[-1]
    count = 20
    for _ in range(count):
        turns = [Rotation.random(random_state=rng.integers(1 << 30)) for _ in names]
        place = rng.normal(size=3)
        place *= rng.uniform(0.25, 0.4) / np.linalg.norm(place)
        poses = [(np.zeros(3), turns[0].as_matrix()), (place, turns[1].as_matrix())]
        expected = distance(names, poses)
        parameters = [turn.as_quat(scalar_first=True) for turn in turns]
        y = np.concatenate([poses[0][0], parameters[0], poses[1][0], parameters[1]])
        travels = np.full((model.equations.speed_count, 1), 10.0)
        gap = source.near(Configuration(0.0, y, model.nominal), travels).distance.min()
        if expected < 1e-3:  # nearly touching or overlapping
            assert gap < 2e-3
            continue
        assert gap <= expected + 1e-6
        exact += abs(gap - expected) < 1e-6
        assert exact or second not in ROUND
        if second in ROUND:
            assert gap == pytest.approx(expected, abs=1e-6)
    assert exact >= count // 3


# motions --------------------------------------------------------------------------------------
def alone(angle: float, friction: float, lying: bool, on_box: bool = False, length: float = 0.4):
    """A cylinder on an inclined plane or box, as inclined gravity."""
    system = da.System("incline", gravity=(G * np.sin(angle), 0.0, -G * np.cos(angle)))
    pose = (
        {"position": (0, 0, 0.1), "rotation": LYING} if lying else {"position": (0, 0, length / 2)}
    )
    body = system.add(spatial.Cylinder("c", radius=0.1, length=length, mass=2.0, **pose))
    ground = system.ground
    floor = contact.HalfSpace(ground.frame())
    if on_box:
        floor = contact.Box(ground.point(0, 0, -0.1), (9.0, 1.0, 0.2))
    shapes = [cylinder(body, 0.1, length), floor]
    system.add(spatial.Collisions("floor", shapes, friction=friction))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("on_box", [False, True])
@pytest.mark.parametrize("friction", [0.05, 0.5])
def test_a_cylinder_rolls_down_an_incline(friction, on_box):
    """``a = 2/3 g sin α`` where it rolls, ``g (sin α − μ cos α)`` where it slips."""
    angle, time = 0.3, 0.4
    motion = da.solve_nonsmooth(alone(angle, friction, True, on_box), time, step=2e-3)
    rolling = 2 / 3 * G * np.sin(angle)
    expected = max(rolling, G * (np.sin(angle) - friction * np.cos(angle)))
    assert motion.status.success
    assert motion["c.vx"][-1] == pytest.approx(expected * time, abs=1e-10)
    assert motion["c.x"][-1] == pytest.approx(expected * time**2 / 2, abs=1e-10)
    assert abs(motion["c.z"] - 0.1).max() < 1e-10


def test_a_disc_slides_flat_on_an_inclined_plane():
    """Its end is parallel to the plane but for rounding: no direction is the lowest."""
    angle, friction, half = 0.3, 0.2, 0.02
    normal = np.array([np.sin(angle), 0, np.cos(angle)])
    system = da.System("disc", gravity=(0.0, 0.0, -G))
    tilted = da.rotation.axis_angle((0, 1, 0), angle)
    place = {"position": tuple(half * normal), "rotation": tilted}
    body = system.add(spatial.Body("d", mass=1.0, inertia=(0.005,) * 3, **place))
    floor = contact.HalfSpace(system.ground.frame(axis=tuple(normal)))
    shapes = [cylinder(body, 0.1, 2 * half), floor]
    system.add(spatial.Collisions("floor", shapes, friction=friction))
    motion = da.solve_nonsmooth(system.build(), 0.2, step=2e-3)
    expected = G * (np.sin(angle) - friction * np.cos(angle)) * 0.2
    assert motion.status.success
    assert motion["d.vx"][-1] == pytest.approx(expected * np.cos(angle), abs=1e-9)


@pytest.mark.thorough
@pytest.mark.parametrize("integrator", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize("floor", ["plane", "box", "cylinder"])
def test_a_disc_that_spins_on_its_end_is_braked_at_its_rim(floor, integrator):
    """``ω̇ = −μ g m R/J``; no point of the rim of an upright disc is the lowest."""
    system = da.System("disc", gravity=(0.0, 0.0, -G))
    spin = {"position": (0, 0, 0.025), "angular_velocity": (0, 0, 10.0)}
    body = system.add(spatial.Cylinder("d", radius=0.1, length=0.05, mass=1.0, **spin))
    ground = system.ground
    floors = {
        "plane": contact.HalfSpace(ground.frame()),
        "box": contact.Box(ground.point(0, 0, -0.1), (1.0, 1.0, 0.2)),
        "cylinder": contact.Cylinder(ground.point(0, 0, -0.2), ground.point(0, 0, 0), 0.3),
    }
    shapes = [cylinder(body, 0.1, 0.05), floors[floor]]
    system.add(spatial.Collisions("floor", shapes, friction=0.3))
    motion = da.solve_nonsmooth(system.build(), 0.1, step=1e-3, integrator=integrator)
    assert motion.status.success
    places = motion.contact_forces(0.001).places
    np.testing.assert_allclose(np.hypot(*places[:, :2].T), 0.1, rtol=1e-3)
    expected = 10.0 - 0.3 * G * 2 / 0.1 * 0.1
    assert motion["d.angular_velocity"][-1, 2] == pytest.approx(expected, rel=2e-3)


@pytest.mark.thorough
@pytest.mark.parametrize("on_box", [False, True])
@pytest.mark.parametrize(("share", "falls"), [(0.9, False), (1.05, True)])
def test_a_standing_cylinder_topples_at_its_angle(share, falls, on_box):
    """``tan α = 2 r/l``"""
    angle = np.arctan(share * 0.5)
    motion = da.solve_nonsmooth(alone(angle, 0.9, False, on_box), 0.5, step=2e-3)
    moved = abs(motion["c.x"]).max()
    assert motion.status.success
    assert (moved > 0.01) if falls else (moved < 1e-9)


@pytest.mark.few(1)
@pytest.mark.parametrize("shift", [0.0, 0.03])
def test_a_stack_of_cylinders_stands(shift):
    system = da.System("stack", gravity=(0.0, 0.0, -G))
    shapes = [contact.HalfSpace(system.ground.frame())]
    for k in range(3):
        place = (shift * k, 0.0, 0.1 + 0.2 * k)
        body = spatial.Cylinder(f"c{k}", radius=0.1, length=0.2, mass=1.0, position=place)
        shapes.append(cylinder(system.add(body), 0.1, 0.2))
    system.add(spatial.Collisions("stack", shapes, friction=0.5))
    motion = da.solve_nonsmooth(system.build(), 0.1, step=2e-3)
    assert motion.status.success
    assert np.ptp(motion.trajectory.y, axis=1).max() < 1e-10
    assert motion.impulse("stack").values[-1] == pytest.approx(G * 2e-3 * 6, rel=1e-7)


@pytest.mark.thorough
@pytest.mark.parametrize("friction", [0.2, 0.3])
def test_a_pyramid_of_cylinders(friction):
    """It stays where ``μ ≥ tan 15°`` (and the lower ones roll apart otherwise)."""
    system = da.System("pyramid", gravity=(0.0, 0.0, -G))
    shapes = [contact.HalfSpace(system.ground.frame())]
    apart = 0.1001
    top = 0.1 + np.sqrt(0.2**2 - apart**2)
    for k, (x, z) in enumerate([(-apart, 0.1), (apart, 0.1), (0.0, top)]):
        body = spatial.Cylinder(
            f"c{k}", radius=0.1, length=0.4, mass=1.0, position=(x, 0, z), rotation=LYING
        )
        shapes.append(cylinder(system.add(body), 0.1, 0.4))
    system.add(spatial.Collisions("pile", shapes, friction=friction))
    motion = da.solve_nonsmooth(system.build(), 0.2, step=2e-3)
    fallen = top - motion["c2.z"][-1]
    assert motion.status.success
    assert (fallen < 1e-9) if friction > np.tan(np.pi / 12) else (fallen > 1e-3)


@pytest.mark.thorough
@pytest.mark.parametrize(("overhang", "falls"), [(0.19, False), (0.21, True)])
def test_a_cylinder_beyond_the_edge_of_a_box(overhang, falls):
    """It tips when its middle is beyond the edge."""
    system = da.System("edge", gravity=(0.0, 0.0, -G))
    place = {"position": (0, overhang, 0.1), "rotation": LYING}
    body = system.add(spatial.Cylinder("c", radius=0.1, length=0.5, mass=1.0, **place))
    table = contact.Box(system.ground.point(0, 0, -0.1), (1.0, 0.4, 0.2))
    shapes = [cylinder(body, 0.1, 0.5), table]
    system.add(spatial.Collisions("touch", shapes, friction=0.5))
    motion = da.solve_nonsmooth(system.build(), 0.3, step=2e-3)
    assert motion.status.success
    assert (abs(motion["c.z"] - 0.1).max() < 1e-9) is not falls


@pytest.mark.thorough
def test_a_disc_rolls_steadily_on_its_rim():
    """Steady circular rolling of a thin disc: with the tilt θ of its plane from the horizontal,
    the centre at rest, ``Ω² = 4 g/(r sin θ)`` (Moffatt, Nature 404, 2000)."""
    radius, tilt, mass = 0.1, 0.3, 1.0
    rate = np.sqrt(4 * G / (radius * np.sin(tilt)))
    system = da.System("disc", gravity=(0.0, 0.0, -G))
    axis = np.array([np.sin(tilt), 0, np.cos(tilt)])
    across = np.array([np.cos(tilt), 0, -np.sin(tilt)])
    rotation = np.column_stack([across, (0.0, 1.0, 0.0), axis])  # lowest at the end of ``across``
    thin = 1e-6
    disc = system.add(
        spatial.Body(
            "disc",
            mass=mass,
            inertia=(mass * radius**2 / 4, mass * radius**2 / 4, mass * radius**2 / 2),
            position=(0, 0, radius * np.sin(tilt) + thin),
            rotation=rotation,
            angular_velocity=tuple(-rate * np.sin(tilt) * across),
        )
    )
    shapes = [cylinder(disc, radius, thin), contact.HalfSpace(system.ground.frame())]
    system.add(spatial.Collisions("floor", shapes, friction=0.8))
    turn = 2 * np.pi / rate
    motion = da.solve_nonsmooth(system.build(), turn, step=turn / 200)
    heights = motion["disc.z"].values
    assert motion.status.success
    assert np.ptp(heights) < 0.01 * heights[0]
    assert np.diff(motion.data["energy"].values).max() < 1e-4


@pytest.mark.thorough
def test_cylinders_among_solids_neither_overlap_nor_gain_energy():
    rng, system = np.random.default_rng(3), da.System("mixture", gravity=(0.0, 0.0, -G))
    shapes = [contact.HalfSpace(system.ground.frame())]
    for axis in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)):
        place = tuple(-0.35 * component for component in axis)
        shapes.append(contact.HalfSpace(system.ground.frame(place, axis=axis)))
    kinds = ["cylinder", "disc", "capsule", "cylinder", "box", "disc", "sphere", "polyhedron"]
    for k, name in enumerate(kinds):
        body = spatial.Body(
            f"b{k}",
            mass=1.0,
            inertia=(4e-3,) * 3,
            position=(-0.16 + 0.32 * (k % 2), -0.16 + 0.32 * (k // 2 % 2), 0.2 + 0.35 * (k // 4)),
            rotation=da.rotation.axis_angle(tuple(rng.normal(size=3)), 1.0 + k),
            velocity=tuple(0.5 * rng.normal(size=3)),
            angular_velocity=tuple(3 * rng.normal(size=3)),
        )
        shapes.append(SHAPES[name](system.add(body)))
    system.add(spatial.Collisions("all", shapes, restitution=0.3, friction=0.3))
    motion = da.solve_nonsmooth(system.build(), 0.28, step=2e-3)
    energy = motion.data["energy"].values
    assert motion.status.success
    assert motion.data["penetration"].max() < 1e-9
    assert motion.statistics["maximum energy gained in contacts [J]"] <= 1e-10
    assert np.diff(energy).max() <= 1e-4 * energy[0]
    assert energy[-1] < energy[0]
