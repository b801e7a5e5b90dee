"""Order of lasting contacts: bodies that roll or turn over a corner, with steps of half the length.

Directions of impulses in the middle of a step have errors of second order, those at its start of
first order.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar, spatial
from dalembert.analysis.nonsmooth.free_bodies.free_body_march import FreeBodyMarch

G, LOWER, UPPER, PLACE = 9.81, 0.5, 0.1, 0.05
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]
SECOND = 3.6
"""Least ratio of the errors with steps of twice the length; 4 for second order, 2 for first."""


def rolling_disc() -> da.Model:
    """A disc on top of a fixed one."""
    system = da.System("disc on a disc", gravity=(0, -G))
    size = LOWER + UPPER
    place = (PLACE, np.sqrt(size**2 - PLACE**2))
    disc = planar.Body("disc", mass=1.0, inertia=UPPER**2 / 2, position=place)
    kit = planar.contact
    shapes = [kit.Circle(system.add(disc).center, UPPER), kit.Circle(system.ground.center, LOWER)]
    system.add(planar.Collisions("touch", shapes, friction=0.6))
    return system.build()


def rolling_ball() -> da.Model:
    """A ball on top of a fixed one."""
    system = da.System("ball on a ball", gravity=(0, 0, -G))
    size = LOWER + UPPER
    place = (PLACE, 0.0, np.sqrt(size**2 - PLACE**2))
    moments = (2 / 5 * UPPER**2,) * 3
    ball = spatial.Body("disc", mass=1.0, inertia=moments, position=place)
    kit = spatial.contact
    shapes = [
        kit.Sphere(system.add(ball).center, UPPER),
        kit.Sphere(system.ground.point(0, 0, 0), LOWER),
    ]
    system.add(spatial.Collisions("touch", shapes, friction=0.6))
    return system.build()


def lean(inertia: float, time: float) -> float:
    """Angle of the centre line of a body that rolls without slip, ``(1 + J/m r²) (R + r) θ̈ = g sin
    θ``."""
    rate = G / ((1 + inertia) * (LOWER + UPPER))
    start = np.arcsin(PLACE / (LOWER + UPPER))
    options = {"rtol": 1e-12, "atol": 1e-14}
    course = solve_ivp(lambda _, z: [z[1], rate * np.sin(z[0])], (0, time), [start, 0.0], **options)
    return float(course.y[0, -1])


@pytest.mark.few(1)
@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("build", "inertia"), [(rolling_disc, 0.5), (rolling_ball, 0.4)])
def test_bodies_roll_with_second_order(build, inertia, scheme, compiled, monkeypatch):
    if not compiled:
        monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    model, time, errors = build(), 0.56, []
    exact = (LOWER + UPPER) * np.sin(lean(inertia, time))
    for step in (8e-3, 4e-3):
        motion = da.solve_nonsmooth(model, time, step=step, integrator=scheme)
        assert motion.status.success
        errors.append(abs(motion.trajectory.y[0, -1] - exact))
    assert errors[0] > SECOND * errors[1] and errors[1] < 1e-4


def tipped_box() -> da.Model:
    """A force tips a box over its corner."""
    system = da.System("tipped box", gravity=(0, -G))
    body = system.add(planar.Body("box", mass=2.0, inertia=0.2 / 6, position=(0, 0.2)))
    system.add(planar.Force("push", body.point(-0.1, 0.2), (1.1 * 2 * G / 4, 0)))
    shapes = [planar.contact.Rectangle(body, (0.2, 0.4)), planar.contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, friction=0.9))
    return system.build()


def turned(time: float) -> float:
    """Angle of the box about its lower right corner, to which the mass centre is at ``r (−sin, cos)
    (α − θ)`` after turning by θ."""
    radius, alpha, push = np.hypot(0.1, 0.2), np.arctan2(0.1, 0.2), 1.1 * 2 * G / 4
    inertia = 0.2 / 6 + 2 * radius**2

    def rate(_: float, z: np.ndarray) -> list[float]:
        weight = -2 * G * radius * np.sin(alpha - z[0])
        lever = 0.4 * np.cos(z[0]) + 0.2 * np.sin(z[0])  # height of the corner that is pushed
        return [z[1], (weight + push * lever) / inertia]

    return float(solve_ivp(rate, (0, time), [0.0, 0.0], rtol=1e-12, atol=1e-14).y[0, -1])


@pytest.mark.few(1)
@pytest.mark.parametrize("compiled", [True, False])
def test_a_box_turns_over_its_corner_with_second_order(compiled, monkeypatch):
    if not compiled:
        monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    model, time = tipped_box(), 0.56
    errors = [
        abs(-da.solve_nonsmooth(model, time, step=step).values("box.angle")[-1] - turned(time))
        for step in (8e-3, 4e-3)
    ]
    assert errors[0] > SECOND * errors[1] and errors[1] < 3e-4


@pytest.mark.thorough
def test_balls_that_are_concentric_in_the_middle_of_a_step_collide():
    """The direction there is not defined; the impact has the one at the start."""
    system, kit = da.System("shot"), spatial.contact
    target = system.add(spatial.Particle("target", mass=1.0, position=(0, 0, 0)))
    start = {"position": (-0.1, 0, 0), "velocity": (10, 0, 0)}
    shot = system.add(spatial.Particle("shot", mass=1.0, **start))
    balls = [kit.Sphere(part.center, 0.02) for part in (target, shot)]
    system.add(spatial.Collisions("hit", balls, restitution=0.5))
    motion = da.solve_nonsmooth(system.build(), 0.1, step=0.02)
    assert motion.values("target.vx")[-1] == pytest.approx(7.5)


def test_half_of_a_rotation_twice_is_the_rotation():
    system = da.System("body")
    system.add(spatial.Body("body", mass=1.0, inertia=(1.0, 1.0, 1.0)))
    manifold = system.build().equations.manifold
    y, delta = np.array([0.1, 0.2, 0.3, 1.0, 0, 0, 0]), np.array([0.3, 0.1, -0.2, 0.9, -0.4, 1.1])
    half = manifold.halfway(delta)
    np.testing.assert_allclose(manifold.go(manifold.go(y, half), half), manifold.go(y, delta))


RIM, WIDTH = 0.2, 0.02
INERTIAS = {"equal": (0.015, 0.015), "thin": (0.0101, 0.02)}
"""Moments of the disc about its diameters and its axis; equal ones cause no gyroscopic moments."""
LEAN = 0.3
"""Start angle of the disc to the vertical [rad]."""
AXIS = np.array([0.0, np.cos(LEAN), np.sin(LEAN)])
SPIN = 8.0 * AXIS + np.array([0.0, 0.0, 1.0])


def lowest(axis: np.ndarray) -> np.ndarray:
    """The contact point of the lower rim from the mass centre."""
    up = np.array([0.0, 0.0, 1.0])
    across = up - axis * axis[2]
    return -RIM * across / np.linalg.norm(across) - WIDTH / 2 * axis


def leaning_disc(moments: tuple[float, float]) -> da.Model:
    """A disc that rolls on its rim."""
    system, arm = da.System("leaning disc", gravity=(0, 0, -G)), lowest(AXIS)
    start = {"position": (0, 0, -arm[2]), "velocity": -np.cross(SPIN, arm)}
    start |= {"angular_velocity": SPIN, "rotation": da.rotation.axis_angle((1, 0, 0), LEAN)}
    inertia = moments[0], moments[1], moments[0]
    disc = spatial.Body("disc", mass=1.0, inertia=inertia, **start)
    ends = system.add(disc).point(0, -WIDTH / 2, 0), disc.point(0, WIDTH / 2, 0)
    kit = spatial.contact
    shapes = [kit.Cylinder(*ends, RIM), kit.HalfSpace(system.ground.frame())]
    system.add(spatial.Collisions("touch", shapes, friction=2.0))
    return system.build()


def rolled(time: float, moments: tuple[float, float]) -> np.ndarray:
    """Mass centre of the disc by ``v̇ = F + g``, ``J ω̇ + ω × J ω = c × F``, with ``v + ω × c = 0``
    where the contact point ``c`` moves along the rim."""
    weight = np.array([0.0, 0.0, -G])

    def rates(_: float, z: np.ndarray) -> np.ndarray:
        axis, v, spin = z[3:6], z[6:9], z[9:]
        turn, arm = np.cross(spin, axis), lowest(axis)
        along = np.linalg.norm(np.array([0.0, 0.0, 1.0]) - axis * axis[2])
        across = -(arm + WIDTH / 2 * axis) / RIM
        change = -turn * axis[2] - axis * turn[2]
        moves = -RIM * (change - across * (across @ change)) / along - WIDTH / 2 * turn
        inertia = moments[0] * np.eye(3) + (moments[1] - moments[0]) * np.outer(axis, axis)
        gyroscopic = np.linalg.solve(inertia, np.cross(inertia @ spin, spin))
        lever = np.cross(np.eye(3), arm)
        mobility = np.eye(3) + lever.T @ np.linalg.solve(inertia, lever)
        still = weight + np.cross(gyroscopic, arm) + np.cross(spin, moves)
        force = -np.linalg.solve(mobility, still)
        angular = gyroscopic + np.linalg.solve(inertia, np.cross(arm, force))
        return np.concatenate([v, turn, force + weight, angular])

    arm = lowest(AXIS)
    start = np.concatenate([[0, 0, -arm[2]], AXIS, -np.cross(SPIN, arm), SPIN])
    return solve_ivp(rates, (0, time), start, rtol=1e-12, atol=1e-14, method="DOP853").y[:3, -1]


@pytest.mark.thorough
@pytest.mark.parametrize("moments", INERTIAS.values(), ids=list(INERTIAS))
def test_a_disc_that_leans_over_rolls_with_second_order(moments):
    """Steps in which the gap is concave have directions that are means over their path."""
    model, time, errors = leaning_disc(moments), 0.4, []
    for step in (4e-3, 2e-3):
        motion = da.solve_nonsmooth(model, time, step=step)
        assert motion.status.success and motion.record.curved.any()
        errors.append(np.abs(motion.trajectory.y[:3, -1] - rolled(time, moments)).max())
    assert errors[0] > SECOND * errors[1] and errors[1] < 3e-5


BALL, MOMENTS = 0.1, np.array([0.002, 0.004, 0.005])
"""Radius and moments of inertia of Chaplygin's ball of 1 kg."""
TURN = np.array([3.0, 5.0, -2.0])


def chaplygin_ball() -> da.Model:
    system = da.System("Chaplygin's ball", gravity=(0, 0, -G))
    start = {"velocity": np.cross(TURN, [0, 0, BALL]), "angular_velocity": TURN}
    ball = spatial.Body("ball", mass=1.0, inertia=MOMENTS, position=(0, 0, BALL), **start)
    kit = spatial.contact
    shapes = [kit.Sphere(system.add(ball).center, BALL), kit.HalfSpace(system.ground.frame())]
    system.add(spatial.Collisions("touch", shapes, friction=1.0))
    return system.build()


def rolled_ball(time: float) -> np.ndarray:
    """Centre of the ball: its angular momentum about the contact point, ``K = J ω + m r² (ω − (ω·γ)
    γ)`` with the vertical ``γ``, is constant (Chaplygin 1903). All in the axes of the ball."""
    upright = BALL**2

    def spin(momentum: np.ndarray, vertical: np.ndarray) -> np.ndarray:
        inertia = np.diag(MOMENTS + upright) - upright * np.outer(vertical, vertical)
        return np.linalg.solve(inertia, momentum)

    def rates(_: float, z: np.ndarray) -> np.ndarray:
        momentum, axes = z[:3], z[3:12].reshape(3, 3)
        own = spin(momentum, axes[2])
        velocity = np.cross(axes @ own, [0, 0, BALL])
        return np.concatenate([np.cross(momentum, own), np.cross(axes, own).ravel(), velocity])

    vertical = np.array([0.0, 0.0, 1.0])
    momentum = MOMENTS * TURN + upright * (TURN - TURN[2] * vertical)
    start = np.concatenate([momentum, np.eye(3).ravel(), BALL * vertical])
    return solve_ivp(rates, (0, time), start, rtol=1e-12, atol=1e-14, method="DOP853").y[-3:, -1]


@pytest.mark.parametrize("compiled", [True, pytest.param(False, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_chaplygins_ball_rolls_with_second_order(scheme, compiled, monkeypatch):
    """Gyroscopic moments are those of the mean speeds, and conserve the energy; friction of
    ``MoreauJean`` exchanges some."""
    if not compiled:
        monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    model, time, errors = chaplygin_ball(), 1.6, []
    exchanged = 1e-11 if scheme.anticipates else 1e-6
    for step in (8e-3, 4e-3):
        motion = da.solve_nonsmooth(model, time, step=step, integrator=scheme)
        assert motion.status.success and np.ptp(motion["energy"].values) < exchanged
        errors.append(np.abs(motion.trajectory.y[:3, -1] - rolled_ball(time)).max())
    assert errors[0] > SECOND * errors[1] and errors[1] < 1e-5
