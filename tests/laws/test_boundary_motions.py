"""Motions with profiles and polygons with dents: cams, gears, Geneva drive, bowl, groove."""

import math

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from thorough import sampled

import dalembert as da
from dalembert import planar
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration

contact = planar.contact
u = da.curves.u
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]
G = 9.81


def turned(angle: float, vector: np.ndarray) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]]) @ vector


def turning(system: da.System, name: str, place, speed: float, angle: float = 0.0) -> planar.Body:
    """A wheel on an axle."""
    start = {"position": place, "angle": angle, "angular_velocity": speed}
    wheel = system.add(planar.Body(name, mass=1.0, inertia=1e-3, **start))
    system.add(planar.Revolute(f"{name}_axle", system.ground.point(*place), wheel.center))
    return wheel


def driven(system: da.System, name: str, place, speed: float, angle: float = 0.0) -> planar.Body:
    """A wheel that turns with constant speed."""
    wheel = turning(system, name, place, speed, angle)
    law = angle + speed * da.t
    system.add(planar.RotationalDriver(f"{name}_motor", system.ground, wheel, law))
    return wheel


def follower(system: da.System, height: float) -> planar.Body:
    """A body that slides along y."""
    body = system.add(planar.Body("follower", mass=1.0, inertia=1.0, position=(0, height), angle=0))
    system.add(planar.Prismatic("guide", system.ground.center, body.center, axis=(0, 1)))
    return body


A, B, ROLLER = 0.2, 0.1, 0.05
ELLIPSE = da.FormulaCurve(A * da.cos(u), B * da.sin(u))


def flat_lift(angle: float) -> float:
    """Height of an ellipse."""
    return math.hypot(A * math.sin(angle), B * math.cos(angle))


def roller_lift(angle: float) -> float:
    """Height of a roller on an ellipse."""

    def center(v: float) -> np.ndarray:
        place = np.array([A * math.cos(v), B * math.sin(v)])
        normal = np.array([B * math.cos(v), A * math.sin(v)])
        x, y = place + ROLLER * normal / np.linalg.norm(normal)
        c, s = math.cos(angle), math.sin(angle)
        return np.array([c * x - s * y, s * x + c * y])

    top = math.pi / 2 - angle
    v = brentq(lambda v: center(v)[0], top - 1.2, top + 1.2)
    return float(center(v)[1])


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("lift", "roller"), [(flat_lift, False), (roller_lift, True)])
def test_an_elliptic_cam_lifts_its_follower(scheme, lift, roller):
    system = da.System("cam", gravity=(0, -G))
    cam = driven(system, "cam", (0, 0), 2.0)
    body = follower(system, lift(0.0))
    shape = contact.HalfPlane(body.center, normal=(0, -1))
    if roller:
        shape = contact.Circle(body.center, ROLLER)
    system.add(planar.Collisions("touch", [contact.Profile(cam, ELLIPSE), shape]))
    motion = da.solve_nonsmooth(system.build(), 0.4, step=4e-3, integrator=scheme)
    expected = [lift(2.0 * t) for t in motion.time]
    above = motion["follower.y"].values - expected
    assert motion.status.success
    assert above.min() > -1e-9
    assert np.abs(above).max() < 2e-4  # O(h²) where the cam is convex


@pytest.mark.thorough
def test_equal_ellipses_about_their_foci_roll_on_each_other():
    """``tan(φ₂/2) = (1 − e)/(1 + e) tan(φ₁/2)`` for axles at a distance 2 a."""
    e, start = math.sqrt(1 - (B / A) ** 2), 0.5
    share = (1 - e) / (1 + e)
    follows = 2 * math.atan(share * math.tan(start / 2))
    rate = share / math.cos(start / 2) ** 2 * math.cos(follows / 2) ** 2
    system = da.System("elliptic gears")
    curve = da.FormulaCurve(A * e + A * da.cos(u), B * da.sin(u))  # about the left focus
    first = driven(system, "first", (0, 0), -1.0, math.pi - start)
    second = turning(system, "second", (2 * A, 0), rate, math.pi + follows)
    system.add(planar.Torque("load", second, -0.1))
    oil = {"stiffness": 0.0, "damping": 0.02}
    system.add(planar.TorsionSpring("oil", system.ground, second, **oil))
    shapes = [contact.Profile(body, curve) for body in (first, second)]
    system.add(planar.Collisions("touch", shapes))
    motion = da.solve_nonsmooth(system.build(), 0.8, step=4e-3, integrator=da.MoreauJean())
    turned = [motion[f"{name}.angle"].values for name in ("first", "second")]
    one, two = math.pi - turned[0], turned[1] - math.pi
    expected = 2 * np.arctan(share * np.tan(one / 2))
    assert motion.status.success
    assert np.abs(two - expected).max() < 2e-4


def flank(base: float, first: float, last: float, angle: float) -> da.FormulaCurve:
    """The involute on the left of a tooth, which begins at an angle on the base circle."""
    x, y = da.cos(u) + u * da.sin(u), da.sin(u) - u * da.cos(u)
    c, s = base * math.cos(angle), base * math.sin(angle)
    return da.FormulaCurve(c * x - s * y, s * x + c * y, -last, -first, closed=False)


@pytest.mark.thorough
def test_involutes_transmit_a_constant_ratio():
    """Exact, except where the next pair of teeth comes into contact: of second order there."""
    teeth, pressure, apart, speed = (16, 24), math.radians(20), 0.4, 3.0
    pitch = [apart * z / sum(teeth) for z in teeth]
    base = [r * math.cos(pressure) for r in pitch]
    system = da.System("gears")
    first = driven(system, "first", (0, 0), speed)
    second = turning(system, "second", (apart, 0), -speed * teeth[0] / teeth[1])
    system.add(planar.Torque("load", second, 1.0))
    roll = math.tan(pressure)
    start, line = roll - pressure, sum(base) * roll  # length of the line of action
    module = 2 * pitch[0] / teeth[0]
    tips = [math.sqrt(((r + 0.9 * module) / b) ** 2 - 1) for r, b in zip(pitch, base, strict=True)]
    roots = [0.8 * (line - base[1 - k] * tips[1 - k]) / base[k] for k in range(2)]
    shapes = []
    for k in range(-7, 3):
        angles = [start + 2 * math.pi * k / teeth[0], math.pi + start - 2 * math.pi * k / teeth[1]]
        for wheel, radius, root, tip, angle in zip(
            (first, second), base, roots, tips, angles, strict=True
        ):
            shapes.append(contact.Profile(wheel, flank(radius, root, tip, angle)))
    system.add(planar.Collisions("mesh", shapes))
    motion = da.solve_nonsmooth(system.build(), 0.25, step=2e-3, integrator=da.MoreauJean())
    error = motion["second.angle"].values + teeth[0] / teeth[1] * motion["first.angle"].values
    assert motion.status.success
    off = np.abs(error - error[0])
    assert np.quantile(off, 0.8) < 1e-12
    assert off.max() < 1e-4


APART, PIN, CLEARANCE = 0.1, 0.004, 2e-5
CRANK = APART / math.sqrt(2)


def geneva() -> list:
    """Corners of a wheel with four slots."""
    slot, outer, depth = PIN + CLEARANCE, 0.99 * CRANK, APART - CRANK - 1.2 * PIN
    corners = []
    for k in range(4):
        c, s = round(math.cos(k * math.pi / 2)), round(math.sin(k * math.pi / 2))
        quarter = [(outer, -slot), (depth, -slot), (depth, slot), (outer, slot)]
        edge = 0.45 * outer
        quarter.append((edge, edge))
        corners += [(c * x - s * y, s * x + c * y) for x, y in quarter]
    return corners


@pytest.mark.thorough
@pytest.mark.parametrize(("scheme", "step"), list(zip(SCHEMES, [1e-3, 2e-3], strict=True)))
def test_a_geneva_drive_turns_by_quarters_and_dwells(scheme, step):
    """In a slot, ``tan ψ = r sin θ/(a − r cos θ)``, within the clearance; then it rests."""
    system, speed = da.System("geneva"), 2 * math.pi
    start = -0.27 * math.pi
    crank = driven(system, "crank", (0, 0), speed, start)
    wheel = turning(system, "wheel", (APART, 0), 0.0, math.pi / 4)
    oil = {"stiffness": 0.0, "damping": 0.2}
    system.add(planar.TorsionSpring("oil", system.ground, wheel, **oil))
    shapes = [contact.Outline(wheel, geneva()), contact.Circle(crank.point(CRANK, 0), PIN)]
    system.add(planar.Collisions("slot", shapes))
    motion = da.solve_nonsmooth(system.build(), 1.3, step=step, integrator=scheme)
    assert motion.status.success
    crank_angle, angle = (motion[f"{name}.angle"].values for name in ("crank", "wheel"))
    turned = angle - math.pi / 4
    passed = np.angle(np.exp(1j * crank_angle))
    ideal = -np.arctan2(CRANK * np.sin(passed), APART - CRANK * np.cos(passed))
    inside = np.abs(passed) < 0.2 * math.pi
    number = np.round((crank_angle - passed) / (2 * math.pi))
    off = turned - (ideal - math.pi / 4 - number * math.pi / 2)
    narrow = APART - CRANK
    assert np.abs(off[inside]).max() < CLEARANCE / narrow
    outside = np.abs(passed) > 0.3 * math.pi  # where the wheel has come to rest
    moved = np.abs(np.diff(angle))[outside[:-1] & outside[1:]]
    assert moved.max() < 1e-6
    assert turned[-1] == pytest.approx(-math.pi, abs=CLEARANCE / narrow)


def parallel(x: float, radius: float) -> np.ndarray:
    """Centre of a disc on the parabola ``y = x²``."""
    return np.array([x, x * x]) + radius * np.array([-2 * x, 1]) / math.hypot(2 * x, 1)


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_disc_slides_in_a_parabolic_bowl(scheme):
    """Beside the motion of a bead on the parallel curve; of first order in the step."""
    radius, start, errors = 0.1, -0.4, []

    def rate(t: float, z: np.ndarray) -> list[float]:
        e = 1e-5
        ahead, here, behind = (parallel(z[0] + d, radius) for d in (e, 0, -e))
        slope, bend = (ahead - behind) / (2 * e), (ahead - 2 * here + behind) / e**2
        return [z[1], (-G * slope[1] - slope @ bend * z[1] ** 2) / (slope @ slope)]

    expected = parallel(
        solve_ivp(rate, (0, 0.4), [start, 0], rtol=1e-9, atol=1e-11).y[0, -1], radius
    )
    system = da.System("bowl", gravity=(0, -G))
    place = tuple(parallel(start, radius))
    disc = system.add(planar.Body("disc", mass=1.0, inertia=5e-3, position=place, angle=0.0))
    bowl = da.FormulaCurve(-u, u * u, -1.0, 1.0, closed=False)
    shapes = [contact.Profile(system.ground, bowl), contact.Circle(disc, radius)]
    system.add(planar.Collisions("bowl", shapes))
    model = system.build()
    for step in (8e-3, 4e-3):
        motion = da.solve_nonsmooth(model, 0.4, step=step, integrator=scheme)
        assert motion.status.success
        assert motion.data["penetration"].max() < 1e-10
        errors.append(np.abs(motion["disc.position"].values[-1] - expected).max())
    assert errors[1] < 0.6 * errors[0] < 6e-3


def test_a_disc_rests_on_both_sides_of_a_narrow_valley():
    """Two contacts of one concave profile; forces by statics."""
    radius, bend = 0.3, 4.0  # of the parabola y = 4 x², curved more than the disc
    system = da.System("valley", gravity=(0, -G))
    x = math.sqrt(radius**2 - 1 / (2 * bend) ** 2)  # |centre − foot| = radius
    height = bend * x * x + 1 / (2 * bend)
    disc = system.add(planar.Body("disc", mass=2.0, inertia=0.1, position=(0, height), angle=0.0))
    valley = da.FormulaCurve(-u, bend * u * u, -0.5, 0.5, closed=False)
    shapes = [contact.Profile(system.ground, valley), contact.Circle(disc, radius)]
    system.add(planar.Collisions("valley", shapes))
    motion = da.solve_nonsmooth(system.build(), 0.1, step=2e-3)
    forces = motion.contact_forces(0.1)
    order = np.argsort(forces.places[:, 0])
    assert np.abs(motion["disc.y"] - height).max() < 1e-9
    assert forces.places[order] == pytest.approx(
        np.array([(-x, bend * x * x), (x, bend * x * x)]), abs=1e-8
    )
    across = G * x / (height - bend * x * x)  # m g/2 over the tangent
    assert forces.forces[order] == pytest.approx(np.array([(across, G), (-across, G)]), rel=1e-6)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("kind", ["point", "polygon"])
def test_a_sharp_corner_stops_at_the_bottom_of_a_dent(kind, scheme):
    """It slides down the upright face of a tooth, and crosses the bottom within a step."""
    system = da.System("tooth", gravity=(0.0, -G))
    tooth = [(-0.1, -0.1), (0.1, -0.1), (0.1, 0.01), (0, 0.01), (0, 0), (-0.03, 0.01), (-0.1, 0.01)]
    start = {"position": (-0.01, 0.02), "velocity": (0.35, -0.35)}
    if kind == "point":
        pawl = system.add(planar.Particle("pawl", mass=0.05, **start))
        tip = contact.Vertex(pawl)
    else:
        pawl = system.add(planar.Body("pawl", mass=0.05, inertia=1e-5, **start))
        tip = contact.Polygon(pawl, [(0.0, 0.0), (0.002, 0.03), (-0.012, 0.03)])
    system.add(planar.Collisions("touch", [tip, contact.Outline(system.ground, tooth)]))
    motion = da.solve_nonsmooth(system.build(), 0.1, step=1e-3, integrator=scheme)
    x, y = motion["pawl.x"].values, motion["pawl.y"].values
    assert motion.status.success
    assert np.minimum(-x, y + x / 3)[y < 0.01].min() > -1e-9
    if kind == "point":
        assert np.hypot(x[-1], y[-1]) < 1e-9


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", sampled(SCHEMES, 2))
def test_a_convex_outline_moves_like_a_polygon(scheme):
    corners, motions = [(-0.15, -0.1), (0.2, -0.05), (0.0, 0.2)], []
    for shape in (contact.Polygon, contact.Outline):
        system = da.System("tumbling", gravity=(0, -G))
        start = {"position": (0.05, 0.5), "angle": 0.4, "velocity": (0.5, 0.0)}
        body = system.add(planar.Body("body", mass=1.0, inertia=0.01, **start))
        bump = contact.Circle(system.ground.center, 0.1)
        floor = contact.HalfPlane(system.ground.point(0, -0.1))
        shapes = [shape(body, corners), bump, floor]
        system.add(planar.Collisions("hits", shapes, friction=0.3, restitution=0.3))
        motions.append(da.solve_nonsmooth(system.build(), 0.8, step=2e-3, integrator=scheme))
    positions = [motion.trajectory.y for motion in motions]
    assert all(motion.status.success for motion in motions)
    assert np.abs(positions[0] - positions[1]).max() < 1e-9


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", sampled(SCHEMES, 2))
def test_many_profiles_fall_into_a_drum(scheme):
    """Ellipses, stars and discs in a bore: nothing penetrates."""
    rng = np.random.default_rng(2)
    system = da.System("drum", gravity=(0, -G))
    star = [((0.06, 0.03)[k % 2] * math.cos(k * math.pi / 5),
             (0.06, 0.03)[k % 2] * math.sin(k * math.pi / 5)) for k in range(10)]  # fmt: skip
    oval, shapes = da.FormulaCurve(0.06 * da.cos(u), 0.03 * da.sin(u)), []
    for k in range(9):
        place = (-0.15 + 0.15 * (k % 3), -0.1 + 0.13 * (k // 3))
        body = planar.Body(f"b{k}", mass=0.1, inertia=1e-4, position=place, angle=6 * rng.random())
        kinds = contact.Profile, contact.Outline, contact.Circle
        data = (system.add(body),), (oval, star, 0.05)
        shapes.append(kinds[k % 3](*data[0], data[1][k % 3]))
    shapes.append(contact.Bore(system.ground.center, 0.3))
    system.add(planar.Collisions("drum", shapes, friction=0.3))
    motion = da.solve_nonsmooth(system.build(), 0.2, step=2e-3, integrator=scheme)
    assert motion.status.success
    assert motion.data["penetration"].max() < 1e-9
    assert motion.statistics["maximum energy gained in contacts [J]"] < 1e-10


def test_rollers_touch_the_teeth_of_sprockets_as_in_contact():
    """Distances of rollers beside the formula of ``Sprocket``."""
    system = da.System("sprocket")
    wheel = system.add(planar.Body("wheel", mass=1.0, inertia=1.0, position=(0, 0), angle=0.0))
    pin = system.add(planar.Body("pin", mass=1.0, inertia=1.0, position=(1, 0), angle=0.0))
    sprocket = contact.Sprocket(wheel.center, 11, 0.0127, 0.00851)
    roller = contact.Circle(pin, 0.00851 / 2)
    system.add(planar.Collisions("seat", [sprocket, roller]))
    model = system.build()
    source, e = gap_sources(model)[0], model.equations
    (point,) = sprocket.contact_points(roller, "seat")
    distance = ca.Function("d", [e.y, e.p], [point.distance])
    radius = float(sprocket.pitch_radius)
    for angle in np.linspace(0, 2 * math.pi / 11, 20):
        place = (radius + 2e-4) * np.array([math.cos(angle), math.sin(angle)])
        y = np.array([0, 0, 0.7, *turned(0.7, place), 0])
        gaps = source.near(Configuration(0.0, y, model.nominal), np.full((6, 1), 0.01))
        expected = float(distance(y, model.nominal))
        if expected > -1e-3:
            assert gaps.distance.min() == pytest.approx(expected, abs=1e-12)


@pytest.mark.thorough
def test_gradients_include_the_form_of_the_curve():
    """Direct and adjoint gradients beside central differences of the run."""
    system = da.System("bowl", gravity=(0, -G))
    bend, friction = system.parameter("bend", 1.0), system.parameter("friction", 0.1)
    start, radius = -0.4, 0.1
    length = da.sqrt(1 + 4 * bend**2 * start**2)
    place = start - 2 * bend * start * radius / length, bend * start**2 + radius / length
    disc = system.add(planar.Body("disc", mass=1.0, inertia=5e-3, position=place, angle=0.0))
    bowl = da.FormulaCurve(-u, bend * u * u, -1.0, 1.0, closed=False)
    shapes = [contact.Profile(system.ground, bowl), contact.Circle(disc, radius)]
    system.add(planar.Collisions("bowl", shapes, friction=friction))
    model = system.build()
    responses = [da.final("disc.x"), da.final("disc.angular_velocity")]

    def run(**values: float) -> da.Motion:
        options = {"step": 2e-3, "integrator": da.MoreauJean(), "parameters": values or None}
        return da.solve_nonsmooth(model, 0.1, **options)

    motion = run()
    direct, adjoint = (
        da.sensitivity(motion, responses, method=method).values for method in ("direct", "adjoint")
    )
    assert direct == pytest.approx(adjoint, rel=1e-9)
    for k, name in enumerate(model.parameters):
        value = float(model.parameters[name].value)
        ends = [run(**{name: value + step}) for step in (1e-5, -1e-5)]
        for response, row in zip(responses, direct, strict=True):
            slope = np.diff([end[response.measure].values[-1] for end in ends])[0] / -2e-5
            assert row[k] == pytest.approx(slope, rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("place", [0.0, 1e-12, 0.3])
def test_a_disc_over_a_straight_corner_of_an_outline_presses_on_one_side(place):
    """``m g = K δ^(3/2)`` at the corner between two sides in one line and beside it."""
    system = da.System("disc on an outline", gravity=(0, -G))
    start = {"position": (place, 0.05), "angle": 0.0}
    disc = system.add(planar.Body("disc", mass=1.0, inertia=1e-3, **start))
    outline = contact.Outline(system.ground, [(-1, -0.2), (1, -0.2), (1, 0), (0, 0), (-1, 0)])
    law = contact.HuntCrossley(stiffness=1e6, damping=5.0)
    system.add(planar.Collisions("contacts", [contact.Circle(disc, 0.05), outline], law=law))
    motion = da.solve_nonsmooth(system.build(), 0.4, step=1e-3)
    assert 0.05 - motion["disc.y"][-1].item() == pytest.approx((G / 1e6) ** (2 / 3), rel=2e-3)
