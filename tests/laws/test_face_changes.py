"""Located rigid contacts that slide over the corners of surfaces, beside own equations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar, spatial
from dalembert.errors import UnsupportedError
from dalembert.results.status import Outcome
from dalembert.sensitivity.checks import event_notes

kit = planar.contact
G, RADIUS, AHEAD = 9.81, 0.05, 0.02
FINE = da.DormandPrince(rtol=1e-10, atol=1e-12)


def table(body, face: float, shape=kit.Polygon, middle: bool = False):
    """A table whose end face has an angle to its top, which ends at the origin."""
    angle = math.radians(face)
    foot = -2.0 / math.tan(angle)
    corners = [(foot - 4, -2.0), (foot, -2.0), (0, 0), *([(-0.01, 0)] if middle else [])]
    return shape(body, [*corners, (-3.0, 0)])


def sliding(
    shape, radius: float, face: float = 90.0, speed: float = 1.0, surface=kit.Polygon, **law
):
    """A point or a disc on a table, ahead of its corner."""
    system = da.System("corner", gravity=(0, -G))
    v = system.parameter("speed", speed, "m/s")
    body = system.add(
        planar.Body(
            "p",
            mass=1.0,
            inertia=0.5 * RADIUS**2,
            position=(-AHEAD, radius),
            velocity=(v, 0),
            angular_velocity=-v / RADIUS if law.get("friction") else 0.0,
        )
    )
    shapes = [table(system.ground, face, surface), shape(body.center)]
    if surface is kit.Outline:
        rigid = kit.Restitution(law.get("restitution", 0.0))
        system.add(planar.Contact("c", *shapes, law=rigid))
    else:
        system.add(planar.Collisions("c", shapes, **law))
    return system.build()


def disc(point):
    return kit.Circle(point, RADIUS)


def over_the_corner(speed: float, end: float, mu: float | None = None, face: float = 90.0):
    """Position and angle of a disc that slides (no ``mu``) or rolls around the corner."""
    k = 0.0 if mu is None else 0.5
    r, turn = RADIUS, math.radians(180 - face)

    def pressure(z):
        return G * math.cos(z[0]) - r * z[1] ** 2

    def rolls(t, z):
        rate = G * math.sin(z[0]) / (r * (1 + k))
        return [z[1], rate, z[1], rate]

    def slips(t, z):
        force = 0.0 if mu is None else mu * pressure(z)
        return [z[1], (G * math.sin(z[0]) - force) / r, z[3], force / (k * r) if k else 0.0]

    def leaves(t, z):
        return pressure(z)

    def sticks(t, z):
        return (mu or 1.0) * pressure(z) - k / (1 + k) * G * math.sin(z[0])

    def turned(t, z):
        return z[0] - turn

    for event in (leaves, sticks, turned):
        event.terminal = True
    t, z = AHEAD / speed, [0.0, speed / r, AHEAD / r, speed / r if k else 0.0]
    parts = [(rolls, [sticks, turned])] if k else []
    for rate, events in [*parts, (slips, [leaves, turned])]:
        run = solve_ivp(rate, (t, end), z, events=events, rtol=1e-12, atol=1e-14)
        t, z = run.t[-1], run.y[:, -1]
        if abs(turned(t, z)) < 1e-9:
            break
    c, s, left = math.cos(z[0]), math.sin(z[0]), end - t
    if abs(turned(t, z)) < 1e-9:  # on along the end face
        way = r * z[1] * left + 0.5 * G * s * left**2 / (1 + k)
        return np.array([r * s + way * c, r * c - way * s])
    v = r * z[1]
    return np.array([r * s + v * c * left, r * c - v * s * left - 0.5 * G * left**2])


def end_of(motion) -> np.ndarray:
    return np.array([motion.values("p.x")[-1], motion.values("p.y")[-1]])


@pytest.mark.parametrize("options", [{"step": 1e-3}, {"integrator": da.DormandPrince()}], ids=str)
@pytest.mark.parametrize("surface", [kit.Polygon, kit.Outline])
@pytest.mark.parametrize("face", [45, 90, 130])
@pytest.mark.parametrize("shape", [kit.Vertex, disc])
def test_bodies_fly_off_a_corner(shape, face, surface, options):
    """At 1 m/s neither a point nor the disc stays on the corner: it falls freely from there."""
    radius = RADIUS if shape is disc else 0.0
    motion = da.solve_dynamics(sliding(shape, radius, face, 1.0, surface), 0.2, **options)
    fall = 0.2 - AHEAD
    assert motion.status.success and not motion.impacts
    np.testing.assert_allclose(end_of(motion), [fall, radius - G * fall**2 / 2], atol=1e-12)


@pytest.mark.parametrize("mu", [None, 0.4])
@pytest.mark.parametrize("options", [{"step": 2e-4}, {"integrator": FINE}], ids=str)
def test_a_disc_leaves_a_corner_where_the_pressure_ends(mu, options):
    """Slow discs turn around the corner until ``m v²/r`` exceeds ``m g cos θ``; with friction they
    roll, then slip."""
    model = sliding(disc, RADIUS, 90.0, 0.2, friction=mu or 0.0)
    motion = da.solve_dynamics(model, 0.4, **options)
    assert motion.status.success and not motion.impacts
    np.testing.assert_allclose(end_of(motion), over_the_corner(0.2, 0.4, mu), atol=1e-9)


@pytest.mark.parametrize("surface", [kit.Polygon, kit.Outline])
@pytest.mark.parametrize("mu", [None, 0.4])
def test_a_disc_stays_on_a_gentle_corner(mu, surface):
    """From the top over the corner onto a face of 5°, without impact; both changes move."""
    if surface is kit.Outline and mu:
        pytest.skip("its contact has no friction here")
    model = sliding(disc, RADIUS, 175.0, 0.2, surface, friction=mu or 0.0)
    motion = da.solve_dynamics(model, 0.4, integrator=FINE)
    assert motion.status.success and not motion.impacts
    np.testing.assert_allclose(end_of(motion), over_the_corner(0.2, 0.4, mu, 175.0), atol=1e-10)
    gradient = da.sensitivity(motion, da.final(model["p.x"]))
    near = [over_the_corner(0.2 + h, 0.4, mu, 175.0)[0] for h in (-1e-5, 1e-5)]
    assert float(gradient.squeeze()) == pytest.approx((near[1] - near[0]) / 2e-5, rel=1e-6)


@pytest.mark.parametrize("method", ["direct", "adjoint"])
@pytest.mark.parametrize("options", [{"step": 5e-4}, {"integrator": FINE}], ids=str)
@pytest.mark.parametrize("mu", [None, 0.4])
def test_gradients_over_a_corner(mu, options, method):
    """Instants at which faces change and the disc leaves move with the speed."""
    model = sliding(disc, RADIUS, 90.0, 0.2, friction=mu or 0.0)
    motion = da.solve_dynamics(model, 0.4, **options)
    responses = [da.final(model["p.x"]), da.final(model["p.y"])]
    gradient = da.sensitivity(motion, responses, method=method).values.ravel()
    near = [over_the_corner(0.2 + h, 0.4, mu) for h in (-1e-5, 1e-5)]
    np.testing.assert_allclose(gradient, (near[1] - near[0]) / 2e-5, rtol=1e-5)


@pytest.mark.parametrize("formulation", [da.KKT(), da.NullSpace(), da.RangeSpace()], ids=str)
def test_formulations_pass_corners(formulation):
    """The end of a capsule, in absolute and in joint coordinates, beside a disc of its radius."""
    system = da.System("capsule", gravity=(0, -G))
    ball = system.add(planar.Particle("p", mass=1.0, position=(-AHEAD, RADIUS), velocity=(0.2, 0)))
    base = system.add(planar.Body("base", mass=1.0, inertia=1.0, position=(0, 0)))
    system.add(planar.Weld("weld", system.ground.center, base.center))
    shapes = (
        kit.Capsule(base.point(-1, 0), base.point(0, 0), 0.03),
        kit.Circle(ball.center, RADIUS - 0.03),
    )
    system.add(planar.Contact("c", *shapes, law=kit.Restitution(0.0)))
    for coordinates in (da.AbsoluteCoordinates(), da.JointCoordinates()):
        options = {"formulation": formulation, "coordinates": coordinates}
        motion = da.solve_dynamics(system.build(), 0.4, integrator=FINE, **options)
        assert motion.status.success
        np.testing.assert_allclose(end_of(motion), over_the_corner(0.2, 0.4), atol=1e-10)


def test_a_ball_leaves_the_edge_of_a_box():
    """The same in space, on an edge of a box."""
    system = da.System("edge", gravity=(0, 0, -G))
    place, velocity = (-AHEAD, 0.1, RADIUS), (0.2, 0, 0)
    ball = system.add(spatial.Particle("p", mass=1.0, position=place, velocity=velocity))
    box = spatial.contact.Box(system.ground.point(-1, 0, -1), (2, 2, 2))
    law = spatial.contact.Restitution(0.0)
    system.add(spatial.Contact("c", box, spatial.contact.Sphere(ball.center, RADIUS), law=law))
    motion = da.solve_dynamics(system.build(), 0.4, integrator=FINE)
    x, height = over_the_corner(0.2, 0.4)
    assert motion.status.success
    np.testing.assert_allclose(motion["p.position"].values[-1], [x, 0.1, height], atol=1e-10)


def ramp(restitution: float, slope: float, speed: float = 1.0, gravity=(0, -G)):
    """A disc on the floor before a ramp; both are faces of one outline."""
    system = da.System("ramp", gravity=gravity)
    v = system.parameter("speed", speed, "m/s")
    ball = system.add(planar.Particle("p", mass=1.0, position=(-0.2, RADIUS), velocity=(v, 0)))
    angle = math.radians(slope)
    corners = [(-1, -0.5), (2, -0.5), (2 * math.cos(angle), 2 * math.sin(angle)), (0, 0), (-1, 0)]
    shapes = kit.Outline(system.ground, corners), kit.Circle(ball.center, RADIUS)
    system.add(planar.Contact("c", *shapes, law=kit.Restitution(restitution)))
    return system.build()


@pytest.mark.parametrize("options", [{"step": 1e-3}, {"integrator": FINE}], ids=str)
@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_dent_is_an_impact(restitution, options):
    """A disc that slides into a ramp strikes it by its law; it slides up, or leaves it."""
    model, a = ramp(restitution, 30), math.radians(30)
    place = -RADIUS * math.tan(a / 2)
    strikes = place + 0.2
    end = 0.4 if not restitution else strikes + 0.01
    motion = da.solve_dynamics(model, end, **options)
    along, normal = np.array([math.cos(a), math.sin(a)]), np.array([-math.sin(a), math.cos(a)])
    left = end - strikes
    if restitution:
        velocity = math.cos(a) * along + restitution * math.sin(a) * normal
        expected = velocity * left + [0, -G / 2 * left**2]
    else:
        expected = (math.cos(a) * left - G / 2 * math.sin(a) * left**2) * along
    assert motion.status.success and len(motion.impacts) == 1
    assert motion.impacts[0].time == pytest.approx(strikes, abs=1e-12)
    assert motion.impacts[0].normal == pytest.approx((1 + restitution) * math.sin(a), abs=1e-10)
    np.testing.assert_allclose(end_of(motion), np.array([place, RADIUS]) + expected, atol=1e-11)
    if not restitution:
        gradient = float(da.sensitivity(motion, da.final(model["p.x"])).squeeze())
        way = math.cos(a) * left + (math.cos(a) - G * math.sin(a) * left) * strikes
        assert gradient == pytest.approx(way * math.cos(a), abs=1e-9)


def test_a_body_between_two_faces_of_one_contact_ends_the_run():
    """Two forces would hold it there, and one contact has a single one."""
    motion = da.solve_dynamics(ramp(0.0, 45, gravity=(3.0, -G)), 3.0, integrator=FINE)
    assert motion.status.outcome is Outcome.CHATTERING
    assert "c moves between faces again and again" in str(motion.status)
    assert "its own Contact" in str(motion.status)


def test_a_disc_rests_at_a_wall():
    """It touches two faces of an outline and only one of them presses."""
    motion = da.solve_dynamics(ramp(0.0, 90), 0.5, integrator=FINE)
    assert motion.status.success
    np.testing.assert_allclose(end_of(motion), [-RADIUS, RADIUS], atol=1e-12)


@pytest.mark.parametrize("shape", [kit.Vertex, disc])
def test_corners_on_straight_sides_are_no_corners(shape):
    """No contact changes at a corner between two sides in one line."""
    system, radius = da.System("straight", gravity=(0, -G)), RADIUS if shape is disc else 0.0
    ball = system.add(planar.Particle("p", mass=1.0, position=(-0.1, radius), velocity=(0.2, 0)))
    top = table(system.ground, 90, middle=True)
    system.add(planar.Collisions("c", [top, shape(ball.center)], restitution=0.0))
    motion = da.solve_dynamics(system.build(), 0.48, step=0.01)
    assert motion.status.success and not motion.statistics.get("contact changes")
    np.testing.assert_allclose(end_of(motion), [-0.1 + 0.2 * 0.48, radius], atol=1e-12)


def test_branches_of_a_formula():
    """The distance of a ``UnilateralConstraint`` is a formula of two faces."""
    system = da.System("formula", gravity=(0, -G))
    p = system.add(planar.Particle("p", mass=1.0, position=(-AHEAD, 0), velocity=(1, 0)))
    slope = (p.x + p.y) * math.sqrt(0.5)
    distance = da.where(p.y > slope, p.y, slope)
    system.add(planar.UnilateralConstraint("c", distance, restitution=0.0))
    motion = da.solve_dynamics(system.build(), 0.2, integrator=da.DormandPrince())
    assert motion.status.success
    np.testing.assert_allclose(end_of(motion), [0.18, -G * 0.18**2 / 2], atol=1e-12)


def test_a_distance_that_jumps_ends_the_run():
    """A floor cannot rise by a jump into a body that rests on it."""
    system = da.System("jump", gravity=(0, -G))
    p = system.add(planar.Particle("p", mass=1.0, position=(0, 0)))
    distance = da.where(da.t < 0.1, p.y, p.y - 0.01)
    system.add(planar.UnilateralConstraint("c", distance, restitution=0.0))
    motion = da.solve_dynamics(system.build(), 0.2, step=0.01)
    assert motion.status.outcome is Outcome.UNDECIDED
    assert "distance of c jumps" in str(motion.status)
    assert motion.time[-1] == pytest.approx(0.1)


def test_instants_without_derivative_are_refused(monkeypatch):
    """A face that changes without a zero of its switching function has no moving instant."""
    model = sliding(disc, RADIUS, 90.0, 0.2)
    motion = da.solve_dynamics(model, 0.4, integrator=FINE)
    kernel, steps = motion.record.kernel, motion.record.steps
    change = next(v for _, v in kernel.crossings(steps) if v.left_branches)
    monkeypatch.setattr(change, "guard", None)
    with pytest.raises(UnsupportedError, match="c_ground_p reaches the end of a face"):
        event_notes.refuse_unlocated(motion)
