"""Tumbling bodies of all shapes: in no step do gaps close or is energy gained; known motions."""

import numpy as np
import pytest
import scipy
from rigid_contacts import other_warnings
from thorough import sampled

import dalembert as da
from dalembert import planar, spatial

G = 9.81
SIZE = 0.1
"""Size of the bodies [m]."""
UNEQUAL = 2e-3, 3e-3, 4.5e-3
"""Moments of inertia [kg m²]."""


def planar_scene(seed: int, friction: float, restitution: float, tilting: bool = False) -> da.Model:
    """Boxes, polygons and capsules that fall between walls, onto a floor that may turn."""
    rng, system, contact = np.random.default_rng(seed), da.System("s", (0, -G)), planar.contact
    left, right = system.ground.point(-0.3, 0.0), system.ground.point(0.3, 0.0)
    shapes = [contact.HalfPlane(left, (1.0, 0.0)), contact.HalfPlane(right, (-1.0, 0.0))]
    floor = system.ground
    if tilting:
        floor = system.add(planar.Body("floor", mass=1.0, inertia=0.01, position=(0.0, 0.0)))
        system.add(planar.Revolute("hinge", system.ground.center, floor.center))
        law = 0.2 * da.sin(8 * da.t)
        system.add(planar.RotationalDriver("motor", system.ground, floor, law))
    shapes.append(contact.HalfPlane(floor.center, (0.0, 1.0)))
    for k in range(9):
        body = planar.Body(
            f"b{k}",
            mass=rng.uniform(0.5, 2.0),
            inertia=rng.uniform(1e-3, 4e-3),
            position=(-0.2 + 0.2 * (k % 3), 0.2 + 0.17 * (k // 3)),
            angle=rng.uniform(0, 2 * np.pi),
            velocity=tuple(0.7 * rng.normal(size=2)),
            angular_velocity=6 * rng.normal(),
        )
        system.add(body)
        angles = np.linspace(0, 2 * np.pi, 5, endpoint=False)
        kinds = [
            contact.Rectangle(body, (0.12, 0.08)),
            contact.Polygon(body, [(0.07 * np.cos(a), 0.07 * np.sin(a)) for a in angles]),
            contact.Capsule(body.point(-0.04, 0.0), body.point(0.04, 0.0), 0.03),
        ]
        shapes.append(kinds[rng.integers(3)])
    system.add(planar.Collisions("all", shapes, friction=friction, restitution=restitution))
    return system.build()


def spatial_scene(
    seed: int, friction: float, restitution: float, inertia: tuple = (3e-3,) * 3
) -> da.Model:
    """Boxes and capsules that fall between walls."""
    rng, contact = np.random.default_rng(seed), spatial.contact
    system = da.System("scene", gravity=(0, 0, -G))
    shapes = [contact.HalfSpace(system.ground.frame())]
    for axis in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)):
        place = tuple(-0.25 * component for component in axis)
        shapes.append(contact.HalfSpace(system.ground.frame(place, axis=axis)))
    for k in range(6):
        body = spatial.Body(
            f"b{k}",
            mass=rng.uniform(0.5, 2.0),
            inertia=inertia,
            position=(-0.12 + 0.24 * (k % 2), -0.12 + 0.24 * (k // 2 % 2), 0.15 + 0.22 * (k // 4)),
            rotation=da.rotation.axis_angle(tuple(rng.normal(size=3)), 1.0 + k),
            velocity=tuple(0.7 * rng.normal(size=3)),
            angular_velocity=tuple(4 * rng.normal(size=3)),
        )
        system.add(body)
        box = contact.Box(body.center, tuple(rng.uniform(0.08, 0.16, 3)))
        ends = body.point(-0.05, 0, 0), body.point(0.05, 0, 0)
        shapes.append(contact.Capsule(*ends, 0.05) if k % 3 == 2 else box)
    system.add(spatial.Collisions("all", shapes, friction=friction, restitution=restitution))
    return system.build()


def check_every_step(motion: da.Motion) -> None:
    """No penetration, no energy gained, all of it accounted for."""
    assert motion.status.success
    assert motion.data["penetration"].max() <= 1e-9 * SIZE
    errors = motion.data["balance_error"].values
    exchanged = np.ptp(motion.data["energy"].values)
    assert np.diff(errors).max() <= 1e-10 * exchanged
    assert motion.statistics["maximum energy gained in contacts [J]"] <= 1e-10 * exchanged


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("seed", "friction", "restitution"),
    [(1, 0.2, 0.6), (2, 0.8, 0.3), (3, 0.5, 0.0), (4, 0.0, 0.9)],
)
def test_planar_bodies_tumble(seed, friction, restitution):
    motion = da.solve_nonsmooth(planar_scene(seed, friction, restitution), 0.5, step=2e-3)
    check_every_step(motion)
    assert np.diff(motion.data["energy"]).max() <= 1e-10 * np.ptp(motion.data["energy"].values)


@pytest.mark.thorough
def test_planar_bodies_tumble_on_a_floor_that_turns():
    check_every_step(da.solve_nonsmooth(planar_scene(5, 0.3, 0.3, True), 0.5, step=2e-3))


@pytest.mark.few(1)
@pytest.mark.parametrize(("seed", "friction", "restitution"), [(1, 0.2, 0.6), (2, 0.5, 0.3)])
def test_spatial_bodies_tumble(seed, friction, restitution):
    motion = da.solve_nonsmooth(spatial_scene(seed, friction, restitution), 0.4, step=2e-3)
    check_every_step(motion)
    assert np.diff(motion.data["energy"]).max() <= 1e-10 * np.ptp(motion.data["energy"].values)


def test_spatial_bodies_with_unequal_moments_of_inertia_tumble():
    motion = da.solve_nonsmooth(spatial_scene(1, 0.3, 0.4, UNEQUAL), 0.4, step=2e-3)
    check_every_step(motion)
    assert np.diff(motion.data["energy"]).max() <= 1e-10 * np.ptp(motion.data["energy"].values)


def check_warnings_of_growth(motion: da.Motion) -> None:
    """A warning about lifted bodies where the energy grows in a step, and no other one."""
    energy, warnings = motion.data["energy"].values, other_warnings(motion)
    growth = np.diff(energy).max() / motion.data["kinetic_energy"].values.max()
    assert bool(warnings) == (growth > 1e-10)
    assert all(text.startswith("corrections of positions, which lift") for text in warnings)


@pytest.mark.thorough
@pytest.mark.parametrize("theta", [0.5, 1.0])
def test_moreau_jean_tumbles_without_refusal(theta):
    """Corrections after impacts lift bodies by a part of the energy, O(h); θ = 1 dissipates."""
    scheme = da.MoreauJean(theta=theta)
    motion = da.solve_nonsmooth(planar_scene(2, 0.5, 0.3), 0.5, step=2e-3, integrator=scheme)
    assert motion.status.success
    check_warnings_of_growth(motion)
    assert motion.data["penetration"].max() <= 1e-9 * SIZE
    assert np.abs(motion.data["balance_error"]).max() <= 2e-3 * np.ptp(motion.data["energy"].values)


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_box_that_fell_comes_to_rest(scheme, restitution):
    """It stands still, on both corners, and does not creep."""
    system = da.System("box", gravity=(0.0, -G))
    start = {"position": (0.0, 0.3), "angle": 0.2, "angular_velocity": 5.0}
    box = system.add(planar.Body("box", mass=1.0, inertia=0.01, **start))
    shapes = [planar.contact.Rectangle(box, (0.4, 0.1)), planar.contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, friction=0.3, restitution=restitution))
    motion = da.solve_nonsmooth(system.build(), 1.6, step=2e-3, integrator=scheme)
    assert motion.status.success
    check_warnings_of_growth(motion)
    assert np.ptp(motion.trajectory.y[:, -200:], axis=1).max() <= 1e-9
    assert motion.record.pressing[-200:].min() == 2
    assert motion.values("box.y")[-1] == pytest.approx(0.05, abs=G * 2e-3**2 * 4)


# torque-free rotation ------------------------------------------------------------------------


SPIN = 2.0, 0.3, 3.0
"""Initial angular velocities about the axes of inertia [rad/s]."""


def spinning() -> da.Model:
    """A free body with unequal moments of inertia, far above a floor."""
    system = da.System("spinning", gravity=(0.0, 0.0, 0.0))
    moments = tuple(1e2 * moment for moment in UNEQUAL)
    start = {"position": (0.0, 0.0, 5.0), "angular_velocity": SPIN}
    body = system.add(spatial.Body("body", mass=1.0, inertia=moments, **start))
    floor = spatial.contact.HalfSpace(system.ground.frame())
    shapes = [spatial.contact.Sphere(body.center, 0.1), floor]
    system.add(spatial.Collisions("floor", shapes))
    return system.build()


def elliptic(t: np.ndarray) -> np.ndarray:
    """(3, K) angular velocities in body axes by Jacobi's elliptic functions (Landau & Lifshitz,
    Mechanics, § 37), for ``L² > 2 T J₂``; the phase follows from the initial second component."""
    a, b, c = (1e2 * moment for moment in UNEQUAL)
    spin, moments = np.array(SPIN), np.array([a, b, c])
    energy, momentum = moments @ spin**2, (moments**2) @ spin**2
    assert momentum > energy * b
    second = np.sqrt((energy * c - momentum) / (b * (c - b)))
    rate = np.sqrt((c - b) * (momentum - energy * a) / (a * b * c))
    modulus = (b - a) * (energy * c - momentum) / ((c - b) * (momentum - energy * a))
    phase = scipy.special.ellipkinc(np.arcsin(spin[1] / second), modulus)
    sn, cn, dn, _ = scipy.special.ellipj(rate * t + phase, modulus)
    first = np.sqrt((energy * c - momentum) / (a * (c - a)))
    third = np.sqrt((momentum - energy * a) / (c * (c - a)))
    return np.array([first * cn, second * sn, third * dn])


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_a_free_body_keeps_its_energy_and_follows_the_elliptic_functions(scheme):
    """Kinetic energy within 1e-14 per step; angular velocities of second order in the step."""
    errors = []
    for step in (2e-2, 1e-2):
        motion = da.solve_nonsmooth(spinning(), 4.0, step=step, integrator=scheme)
        spin = motion.trajectory.v[3:]
        energy = motion.data["kinetic_energy"].values
        assert np.abs(np.diff(energy)).max() <= 1e-14 * energy[0]
        errors.append(np.abs(spin - elliptic(np.asarray(motion.time))).max())
    assert errors[0] <= 2e-2
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


# known motions -------------------------------------------------------------------------------


def standing_polygon(corners: list, mass_center: tuple, inertia: float, spin: float) -> da.Model:
    """A polygon with one corner at the origin, about which it turns; it does not slip."""
    system, contact = da.System("polygon", gravity=(0.0, -G)), planar.contact
    x, y = mass_center
    start = {"position": (x, y), "velocity": (-spin * y, spin * x), "angular_velocity": spin}
    body = system.add(planar.Body("body", mass=1.0, inertia=inertia, angle=0.0, **start))
    shapes = [contact.Polygon(body, corners), contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, friction=3.0))
    return system.build()


def turned(corners: np.ndarray, angle: float) -> np.ndarray:
    """Corners (n, 2) after a rotation about the origin."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return corners @ np.array([[cosine, sine], [-sine, cosine]])


def speed_after_impact(speed: float, inertia: float, radius: float, between: float) -> float:
    """Angular velocity after the support moved to a corner that is seen at an angle ``between``
    from the mass centre: its angular momentum about the new corner is conserved (Housner 1963)."""
    return speed * (inertia + radius**2 * np.cos(between)) / (inertia + radius**2)


WIDTH, HEIGHT = 0.2, 0.6
HALF, RADIUS = np.arctan2(WIDTH, HEIGHT), np.hypot(WIDTH, HEIGHT) / 2
INERTIA = (WIDTH**2 + HEIGHT**2) / 12
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]
schemes = pytest.mark.parametrize("scheme", SCHEMES)


def block(angle: float, spin: float = 0.0) -> da.Model:
    """A slender block that leans by an angle on its lower left corner."""
    box = np.array([[0, 0], [WIDTH, 0], [WIDTH, HEIGHT], [0, HEIGHT]])
    box, center = turned(box, angle), turned(np.array([[WIDTH, HEIGHT]]) / 2, angle)[0]
    return standing_polygon((box - center).tolist(), tuple(center), INERTIA, spin)


@pytest.mark.few(1)
@schemes
def test_a_block_rocks_as_housner_says(scheme):
    """Time of the first impact, and the angular velocities before and after it, which the weight
    changes with the lean."""
    lean, step = 0.1, 5e-4
    motion = da.solve_nonsmooth(block(lean), 0.22, step=step, integrator=scheme)
    rate = 2 * G * RADIUS / (INERTIA + RADIUS**2)
    angle = np.linspace(0, 1, 20001)[1:] ** 2 * lean  # from the start, where the speed is zero
    middle = lean - (angle[1:] + angle[:-1]) / 2
    fall = np.sqrt(rate * (np.cos(HALF - lean) - np.cos(HALF - middle)))
    time = (np.diff(angle) / fall).sum() + np.sqrt(4 * angle[0] / (rate * np.sin(HALF - lean)))
    before = -np.sqrt(rate * (np.cos(HALF - lean) - np.cos(HALF)))
    after = speed_after_impact(before, INERTIA, RADIUS, 2 * HALF)
    turn = motion.values("body.angle")
    k = int(np.argmax(turn < -lean))
    assert motion.time[k] == pytest.approx(time, abs=4 * step)
    speed = motion.values("body.angular_velocity")
    for row, upright in ((k - 4, before), (k + 4, after)):
        lifted = rate * (np.cos(HALF - abs(turn[row] + lean)) - np.cos(HALF))
        assert speed[row] == pytest.approx(-np.sqrt(upright**2 - lifted), rel=2e-2)


def test_a_box_tips_over_its_edge_with_the_energy_of_a_pendulum():
    """The corner does not move, and little energy is lost."""
    lean = HALF + 0.2  # beyond the balance
    motion = da.solve_nonsmooth(block(lean), 0.4, step=5e-4)
    turn, speed = motion.values("body.angle"), motion.values("body.angular_velocity")
    kinetic = (INERTIA + RADIUS**2) * speed**2 / 2
    fallen = G * RADIUS * (np.cos(lean - HALF) - np.cos(lean + turn - HALF))
    assert turn[-1] > 0.3
    assert kinetic == pytest.approx(fallen, abs=5e-3 * fallen[-1])
    energy = motion.data["energy"].values
    assert np.diff(energy).max() <= 1e-10 * fallen[-1]
    assert energy[0] - energy[-1] <= 1e-3 * fallen[-1]


@pytest.mark.parametrize("scheme", sampled(SCHEMES, 2))
def test_a_hexagon_rolls_from_corner_to_corner(scheme):
    """The angular velocity falls by the same factor in each impact."""
    radius, inertia, spin = 0.1, 0.008, -8.0
    corners = radius * np.array([[np.sin(a), -np.cos(a)] for a in np.pi / 3 * np.arange(6)])
    motion = da.solve_nonsmooth(
        standing_polygon(corners.tolist(), (0.0, radius), inertia, spin),
        0.6,
        step=5e-4,
        integrator=scheme,
    )
    drop = radius * (1 - np.cos(np.pi / 6))
    expected = spin
    for _ in range(2):
        before = -np.sqrt(expected**2 + 2 * G * drop / (inertia + radius**2))
        after = speed_after_impact(before, inertia, radius, np.pi / 3)
        expected = -np.sqrt(after**2 - 2 * G * drop / (inertia + radius**2))
    turn = -motion.values("body.angle")
    speed = motion.values("body.angular_velocity")
    k = int(np.argmax(turn >= 2 * np.pi / 3))  # on its third corner, upright
    assert k > 0 and motion.status.success
    assert speed[k] == pytest.approx(expected, rel=4e-2)
