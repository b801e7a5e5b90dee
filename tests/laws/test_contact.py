"""Contact: gaps against geometry, forces in pairs, gradients over touching, refusals."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import planar, spatial
from dalembert.elements.contact.collisions import takes
from dalembert.elements.contact.contact import supported_pairs
from dalembert.elements.registry import SHAPES

kit, solid = planar.contact, spatial.contact
HERTZ = kit.Hertz(stiffness=1e4)
SQUARE = [(-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2)]


# gaps ----------------------------------------------------------------------------------------
def gap_of(make, place, turned: float) -> float:
    """Gap of a contact of the ground with a body at a place, turned by an angle."""
    system = da.System("pair")
    body = planar.Body("b", mass=1.0, inertia=1.0, position=place, angle=turned)
    body = system.add(body)
    system.add(planar.Contact("c", *make(system.ground, body), law=HERTZ))
    return value(system.build(), "c.gap")


def value(model: da.Model, name: str) -> float:
    e, start = model.equations, model.start
    measure = ca.Function("m", [e.t, e.y, e.v, e.p], [model[name].sx])
    return float(measure(0.0, start.y, start.v, model.nominal))


def box_distance(place, size) -> float:
    """Signed distance from a box about the origin."""
    beyond = np.abs(place) - np.array(size) / 2
    return np.linalg.norm(np.maximum(beyond, 0)) + min(beyond.max(), 0.0)


def ellipse_distance(place) -> float:
    """Distance from an ellipse, by a search."""

    def away(u):
        return np.hypot(0.5 * np.cos(u) - place[0], 0.3 * np.sin(u) - place[1])

    about = min(np.linspace(0, 2 * np.pi, 400), key=away)
    return float(minimize_scalar(away, bounds=(about - 0.05, about + 0.05), method="bounded",
                                 options={"xatol": 1e-12}).fun)  # fmt: skip


ELLIPSE = da.FormulaCurve(0.5 * da.cos(da.curves.u), 0.3 * da.sin(da.curves.u))
CORNERS = np.array(SQUARE)


def turned(angle: float, points) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.atleast_2d(points) @ np.array([[c, s], [-s, c]])


PAIRS = {
    "ball on line": (
        lambda g, b: (kit.HalfPlane(g.point(0.1, 0.2), (3, 4)), kit.Circle(b.center, 0.2)),
        lambda r, a: (r - (0.1, 0.2)) @ (0.6, 0.8) - 0.2,
    ),
    "line on ball": (
        lambda g, b: (kit.Circle(b.center, 0.2), kit.HalfPlane(g.point(0.1, 0.2), (3, 4))),
        lambda r, a: (r - (0.1, 0.2)) @ (0.6, 0.8) - 0.2,
    ),
    "ball on ball": (
        lambda g, b: (kit.Circle(g.point(0.1, 0.2), 0.3), kit.Circle(b.point(0.1, 0), 0.2)),
        lambda r, a: np.linalg.norm(r + turned(a, (0.1, 0))[0] - (0.1, 0.2)) - 0.5,
    ),
    "pin in bore": (
        lambda g, b: (kit.Bore(g.point(0, 0), 2.0), kit.Circle(b.center, 0.2)),
        lambda r, a: 1.8 - np.linalg.norm(r),
    ),
    "ball on box": (
        lambda g, b: (kit.Rectangle(g.point(0, 0), (0.6, 0.4)), kit.Circle(b.center, 0.2)),
        lambda r, a: box_distance(r, (0.6, 0.4)) - 0.2,
    ),
    "ball on polygon": (
        lambda g, b: (kit.Circle(b.center, 0.2), kit.Polygon(g, SQUARE)),
        lambda r, a: box_distance(r, (0.6, 0.4)) - 0.2,
    ),
    "box on line": (
        lambda g, b: (kit.HalfPlane(g.point(0, 0)), kit.Rectangle(b.center, (0.6, 0.4))),
        lambda r, a: (r + turned(a, CORNERS))[:, 1].min(),
    ),
    "ball on curve": (
        lambda g, b: (kit.Profile(g, ELLIPSE), kit.Circle(b.center, 0.2)),
        lambda r, a: ellipse_distance(r) - 0.2,
    ),
    "curve on line": (
        lambda g, b: (kit.HalfPlane(g.point(0, 0)), kit.Profile(b, ELLIPSE)),
        lambda r, a: r[1] - np.hypot(0.5 * np.sin(a), 0.3 * np.cos(a)),
    ),
}


@pytest.mark.product
@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("place", [(0.9, 0.8), (0.45, 0.75), (-0.2, 0.6), (0.7, 0.3)])
def test_gaps_are_distances(pair, place):
    make, distance = PAIRS[pair]
    gap = gap_of(make, place, 0.4)
    assert gap == pytest.approx(distance(np.array(place), 0.4), abs=1e-9)


@pytest.mark.parametrize("size", [(0.6, 0.4, 0.5)])
@pytest.mark.parametrize("place", [(0.9, 0.8, 0.7), (0.1, 0.05, 0.6), (0.5, 0.1, 0.4)])
def test_gaps_in_space(size, place):
    axis, angle, r = np.array([1.0, 2.0, 2.0]) / 3, 0.7, np.array(place)
    rotation = Rotation.from_rotvec(angle * axis).as_matrix()
    system, ground = da.System("pair", gravity=(0, 0, -1)), None
    ground = system.ground
    arguments = {"mass": 1.0, "inertia": (1, 1, 1), "position": place}
    b = spatial.Body("b", rotation=da.rotation.axis_angle(axis, angle), **arguments)
    b = system.add(b)
    floor = solid.HalfSpace(ground.frame((0, 0, 0.1), axis=(0, 0, 1)))
    corner, ends = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T * size / 2, (0.2, -0.2)
    ground_point = ground.point(0, 0, 0)
    tips = [b.point(0, 0, end) for end in ends]
    pairs = {
        "boxed": (floor, solid.Box(b.point(0, 0, 0), size)),
        "ball": (solid.Box(ground_point, size), solid.Sphere(b.center, 0.2)),
        "pill": (floor, solid.Capsule(*tips, 0.1)),
        "pilled": (solid.Capsule(*tips, 0.1), solid.Sphere(ground_point, 0.2)),
        "socket": (solid.Socket(ground_point, 2.0), solid.Sphere(b.center, 0.2)),
    }
    for name, shapes in pairs.items():
        system.add(spatial.Contact(name, *shapes, law=HERTZ))
    model = system.build()
    line = r @ rotation[:, 2]
    nearest = r - np.clip(line, -0.2, 0.2) * rotation[:, 2]
    wanted = {
        "boxed": (r + corner @ rotation.T)[:, 2].min() - 0.1,
        "ball": box_distance(r, size) - 0.2,
        "pill": min((r + end * rotation[:, 2])[2] for end in ends) - 0.2,
        "pilled": np.linalg.norm(nearest) - 0.3,
        "socket": 1.8 - np.linalg.norm(r),
    }
    for name, distance in wanted.items():
        assert value(model, f"{name}.gap") == pytest.approx(distance, abs=1e-12), name


def test_corners_of_a_mesh_rest_on_a_plane_and_touch_a_ball(tmp_path):
    """A wedge, whose corners are counted one by one."""
    pytest.importorskip("trimesh")
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
    faces = ["f 1 3 2", "f 1 2 4", "f 2 3 4", "f 1 4 3"]
    lines = [*(f"v {x} {y} {z}" for x, y, z in corners), *faces]
    (tmp_path / "wedge.obj").write_text("\n".join(lines))
    system = da.System("mesh", gravity=(0, 0, -1))
    wedge = spatial.Mesh("w", file=tmp_path / "wedge.obj", density=1.0, position=(0.2, 0.1, 0.7))
    wedge = system.add(wedge)
    shape = solid.Corners(wedge)
    floor = solid.HalfSpace(system.ground.frame((0, 0, 0.1)))
    ball = solid.Sphere(system.ground.point(2.0, 0, 0.7), 0.5)
    system.add(spatial.Contact("floor", floor, shape, law=HERTZ))
    system.add(spatial.Contact("ball", shape, ball, law=HERTZ))
    model = system.build()
    places = corners + np.array([0.2, 0.1, 0.7])
    assert value(model, "floor.gap") == pytest.approx(places[:, 2].min() - 0.1, abs=1e-12)
    away = np.linalg.norm(places - (2.0, 0, 0.7), axis=1).min() - 0.5
    assert value(model, "ball.gap") == pytest.approx(away, abs=1e-12)


# forces --------------------------------------------------------------------------------------
@pytest.mark.few(2)
@pytest.mark.parametrize("pair", PAIRS)
def test_rubbing_pairs_keep_their_momentum(pair):
    """What presses and rubs on one body does the opposite on the other: free ones keep both."""
    make, _ = PAIRS[pair]
    system = da.System("free")
    a = system.add(planar.Body("a", mass=2.0, inertia=0.5, velocity=(0.3, 0.1), position=(0, 0)))
    place, speed = ((0.2, 0.45), (0.0, -1.0)) if "bore" not in pair else ((0.0, 1.9), (0.3, 0.5))
    b = planar.Body("b", mass=1.0, inertia=0.1, position=place, angle=0.4, velocity=speed)
    b = system.add(b)
    law, friction = kit.HuntCrossley(stiffness=300.0, damping=0.3), kit.Coulomb(0.4, slip_speed=0.1)
    system.add(planar.Contact("c", *make(a, b), law=law, friction=friction))
    motion = da.solve_dynamics(system.build(), 0.3, integrator=da.DormandPrince(rtol=1e-9))
    assert motion.status.success
    assert motion["c.force"].max() > 0
    linear = sum(m * motion[f"{n}.velocity"].values for n, m in (("a", 2.0), ("b", 1.0)))
    spin = sum(
        j * motion[f"{n}.angular_velocity"].values
        + m * (motion[f"{n}.x"] * motion[f"{n}.vy"] - motion[f"{n}.y"] * motion[f"{n}.vx"]).values
        for n, m, j in (("a", 2.0, 0.5), ("b", 1.0, 0.1))
    )
    np.testing.assert_allclose(linear, linear[[0]].repeat(len(linear), 0), atol=1e-7)
    np.testing.assert_allclose(spin, spin[0], atol=1e-7)
    assert np.abs(motion.data.balance_error).max() < 1e-6


@pytest.mark.thorough
def test_a_curve_that_is_a_circle_is_one():
    """Roller on a cam and disc on disc: the same motion, with friction."""
    ends = []
    for round_one in (True, False):
        system = da.System("discs", gravity=(0.0, -9.81))
        circle = da.FormulaCurve(0.3 * da.cos(da.curves.u), 0.3 * da.sin(da.curves.u))
        start = {"position": (0, 0), "angle": 0.0, "angular_velocity": 2.0}
        cam = system.add(planar.Body("cam", mass=1.0, inertia=0.05, **start))
        system.add(planar.Revolute("O", system.ground.point(0, 0), cam.center))
        ball = system.add(planar.Body("ball", mass=0.5, inertia=1e-3, position=(0.05, 0.52)))
        shape = kit.Circle(cam.center, 0.3) if round_one else kit.Profile(cam, circle)
        law, friction = kit.HuntCrossley(stiffness=1e6, damping=0.5), kit.Coulomb(0.4)
        shapes = shape, kit.Circle(ball.center, 0.1)
        system.add(planar.Contact("c", *shapes, law=law, friction=friction))
        integrator = da.DormandPrince853(rtol=1e-10, atol=1e-12)
        motion = da.solve_dynamics(system.build(), 0.4, integrator=integrator)
        ends.append(
            [motion[f"{n}"].values[-1] for n in ("ball.x", "ball.y", "ball.angle", "cam.angle")]
        )
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-7)


# gradients -----------------------------------------------------------------------------------
def bouncing(exponent: float) -> da.Model:
    system = da.System("bounce", gravity=(0.0, -9.81))
    k, c = system.parameter("k", 1e5), system.parameter("c", 0.3)
    mu, radius = system.parameter("mu", 0.2), system.parameter("radius", 0.1)
    spin = system.parameter("spin", 5.0)
    start = {"position": (0, 0.5), "velocity": (1.0, 0), "angular_velocity": spin}
    ball = system.add(planar.Body("ball", mass=1.0, inertia=0.004, **start))
    system.add(
        planar.Contact(
            "floor",
            kit.HalfPlane(system.ground.point(0, 0), (0.1, 1)),
            kit.Circle(ball.center, radius),
            law=kit.HuntCrossley(stiffness=k, damping=c, exponent=exponent),
            friction=kit.Coulomb(mu, slip_speed=0.05),
        )
    )
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize(("exponent", "exact"), [(1.0, 1e-6), (1.5, 1e-4), (2.0, 1e-6)])
def test_gradients_over_touching_and_parting(exponent, exact):
    """Direct is adjoint, and the derivative of the motion itself; the start of δ^1.5 costs."""
    model = bouncing(exponent)
    integrator = da.DormandPrince853(rtol=1e-12, atol=1e-14)
    responses = [da.final("ball.x"), da.final("ball.y"), da.final("ball.angular_velocity")]
    motion = da.solve_dynamics(model, 0.7, integrator=integrator)
    direct, adjoint = (
        da.sensitivity(motion, responses, method=m).values for m in ("direct", "adjoint")
    )
    size = np.abs(direct).max(axis=0)
    assert np.max(np.abs(direct - adjoint) / size) < 1e-9

    def end(name: str, by: float) -> np.ndarray:
        moved = {name: float(model.parameters[name].value) * (1 + by)}
        run = da.solve_dynamics(model, 0.7, integrator=integrator, parameters=moved)
        return np.array([run[r.measure].values[-1] for r in responses])

    for k, name in enumerate(model.parameters):
        step = 1e-4
        slope = (end(name, step) - end(name, -step)) / (2 * step)
        slope /= float(model.parameters[name].value)
        assert np.max(np.abs(direct[:, k] - slope)) < max(exact, 3e-6) * size[k], name


# refusals ------------------------------------------------------------------------------------
def test_every_shape_meets_another():
    for dimension, shapes in SHAPES.items():
        named = {end for pair in supported_pairs(dimension) for end in pair.split("–")}
        assert {name for name, shape in shapes.items() if not takes(shape)} <= named
        assert set(shapes) - named <= {"HeightField", "MeshHulls"}  # of Collisions only


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda g, b: (kit.HalfPlane(g.center), kit.HalfPlane(b.center)), "no contact of Half"),
        (lambda g, b: (kit.HalfPlane(g.center), 3), "shape_j must be a shape"),
        (lambda g, b: (kit.HalfPlane(b.center), kit.Circle(b.center, 1)), "to itself"),
        (lambda g, b: (kit.Circle(g.point(0, 0, 0), 1), b.center), "give it 2"),
        (lambda g, b: (solid.Sphere(g.point(0, 0, 0), 1), b.center), "lies in a plane"),
        (lambda g, b: (kit.Polygon(g, [(0, 0), (1, 0)]), b.center), "at least 3 vertices"),
        (lambda g, b: (g.center, solid.Polyhedron(b, np.eye(4)[:, :3])), "b lies in a plane"),
    ],
)
def test_shapes_without_contact_are_refused(make, message):
    system = da.System("refused")
    body = system.add(planar.Body("b", mass=1.0, inertia=1.0))
    with pytest.raises(da.ModelError, match=message):
        system.add(planar.Contact("c", *make(system.ground, body), law=HERTZ))


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (lambda: kit.HuntCrossley(stiffness=1.0), "give restitution= and impact_speed="),
        (lambda: kit.HuntCrossley(stiffness=1.0, restitution=0.5, damping=1.0), "not both"),
        (lambda: kit.Flores(stiffness=1.0, restitution=0.0, impact_speed=1.0), "above zero"),
        (lambda: kit.Flores(stiffness=1.0, restitution=1.2, impact_speed=1.0), "above 1"),
        (lambda: kit.Hertz(stiffness=-1.0), "law.stiffness"),
        (lambda: kit.Restitution(1.5), "above 1"),
        (lambda: 1e6, "law must be one such as"),
    ],
)
def test_invalid_laws_are_refused(law, message):
    system = da.System("refused")
    body = system.add(planar.Body("b", mass=1.0, inertia=1.0))

    def build() -> None:
        ends = system.ground.center, kit.Circle(body.center, 1)
        system.add(planar.Contact("c", *ends, law=law()))
        system.build()

    with pytest.raises(da.ModelError, match=message):
        build()


def test_static_friction_is_not_below_dynamic():
    system = da.System("refused")
    body = system.add(planar.Body("b", mass=1.0, inertia=1.0))
    friction = kit.Coulomb(0.3, 0.2)
    ends = system.ground.center, kit.Circle(body.center, 1)
    system.add(planar.Contact("c", *ends, law=HERTZ, friction=friction))
    with pytest.raises(da.ModelError, match="static= is below"):
        system.build()


def test_rigid_contact_makes_no_forces_and_says_how_it_bounces():
    system = da.System("rigid")
    body = system.add(planar.Body("b", mass=1.0, inertia=1.0))
    law, friction = kit.Restitution(0.7, 0.2), kit.Coulomb(0.3)
    ends = kit.HalfPlane(system.ground.center), kit.Rectangle(body.center, (1, 1))
    element = system.add(planar.Contact("c", *ends, law=law, friction=friction))
    impact = element.impact()
    assert [float(s) for s in (impact.restitution, impact.tangential, impact.friction)] == [
        *(0.7, 0.2, 0.3)
    ]
    assert element.powers(lambda s: s) == [] and element.potential() is None
    assert len(element.gaps(lambda s: s)) == 4
    assert system.build().diagnosis.degrees_of_freedom == 3


def test_polyhedra_are_fixed_to_the_ground():
    """A ball slides down a wedge."""
    corners = [(-4, 0, 0), (4, 0, 3), (4, 0, 0), (-4, 1, 0), (4, 1, 3), (4, 1, 0)]
    down, up = np.array([-8, 0, -3]) / np.sqrt(73), np.array([-3, 0, 8]) / np.sqrt(73)
    system = da.System("wedge", gravity=(0, 0, -9.81))
    start = {"position": (0, 0.5, 1.5 + 0.1 / up[2])}
    ball = system.add(spatial.Sphere("ball", radius=0.1, mass=1.0, **start))
    shapes = [solid.Sphere(ball.center, 0.1), solid.Polyhedron(system.ground, corners)]
    system.add(spatial.Collisions("touch", shapes))
    motion = da.solve_nonsmooth(system.build(), 0.2, step=1e-3)
    speed = np.array([motion[f"ball.v{axis}"].values[-1] for axis in "xyz"])
    assert speed @ down == pytest.approx(9.81 * 3 / np.sqrt(73) * 0.2, rel=1e-9)
