"""Rolling and spinning friction of rigid contacts against closed forms.

A disc or ball of radius ``r`` and inertia ``κ m r²`` that rolls on a plane with the coefficient
``c`` of rolling friction decelerates by ``(c/r) g/(1 + κ)``; on an incline it remains at rest up to
``tan α = c/r``. A ball that spins about the normal with the coefficient ``c`` decelerates by
``c m g/I`` (Leine & van de Wouw, Stability and Convergence of Mechanical Systems, 2008, ch. 5).
"""

from __future__ import annotations

import functools

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.errors import ModelError

G, R, M, ROLLING, SPINNING = 9.81, 0.1, 2.0, 0.002, 0.005
DURATION, STEP = 0.5, 1e-3
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]


@functools.cache
def disc(speed: float, spin: float, angle: float = 0.0, rolling: float = ROLLING) -> da.Model:
    """A disc on a plane inclined by an angle."""
    gravity = (G * np.sin(angle), -G * np.cos(angle))
    system = da.System("disc", gravity=gravity)
    coefficient = system.parameter("rolling", rolling, "m")
    body = planar.Body(
        "disc",
        mass=M,
        inertia=M * R**2 / 2,
        position=(0, R),
        velocity=(speed, 0),
        angular_velocity=spin,
    )
    shapes = [
        planar.contact.Circle(system.add(body), R),
        planar.contact.HalfPlane(system.ground),
    ]
    system.add(planar.Collisions("floor", shapes, friction=0.5, rolling=coefficient))
    return system.build()


def ball(velocity, spin, shape: str = "Sphere") -> da.Model:
    """A ball on a plane; its shape is a sphere or, as a hull, a capsule of no length."""
    system = da.System("ball", gravity=(0, 0, -G))
    inertia = 0.4 * M * R**2
    body = spatial.Body(
        "ball",
        mass=M,
        inertia=(inertia, inertia, inertia),
        position=(0, 0, R),
        velocity=velocity,
        angular_velocity=spin,
    )
    system.add(body)
    if shape == "Sphere":
        own = spatial.contact.Sphere(body, R)
    else:
        own = spatial.contact.Capsule(body.point(0, 0, 0), body.point(0, 0, 1e-9), R)
    floor = spatial.contact.HalfSpace(system.ground)
    law = {"friction": 0.5, "rolling": ROLLING, "spinning": SPINNING}
    system.add(spatial.Collisions("floor", [own, floor], **law))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_rolling_disc_decelerates(scheme):
    motion = da.solve_nonsmooth(disc(1.0, -1.0 / R), DURATION, step=STEP, integrator=scheme)
    deceleration = ROLLING / R * G / 1.5
    assert motion.status.success
    assert motion["disc.vx"][-1].item() == pytest.approx(1 - deceleration * DURATION, abs=1e-9)
    distance = DURATION - deceleration * DURATION**2 / 2
    assert motion["disc.x"][-1].item() == pytest.approx(distance, abs=1e-9)
    energy = 0.75 * M * (1 - (1 - deceleration * DURATION) ** 2)
    assert motion.data["dissipated_energy"][-1].item() == pytest.approx(energy, rel=1e-8)


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_rolling_disc_stops_and_rests(scheme):
    """It stops after ``v (1 + κ) r/(c g)`` and remains."""
    motion = da.solve_nonsmooth(disc(0.02, -0.02 / R), 0.4, step=STEP, integrator=scheme)
    stops = 0.02 * 1.5 * R / (ROLLING * G)
    assert abs(motion["disc.vx"][-1]) < 1e-10
    assert motion["disc.x"][-1].item() == pytest.approx(0.02 * stops / 2, abs=0.02 * STEP)


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("share", [0.98, 1.5])
def test_disc_on_an_incline_rests_below_the_limit(scheme, share):
    angle = np.arctan(share * ROLLING / R)
    motion = da.solve_nonsmooth(disc(0.0, 0.0, angle), DURATION, step=STEP, integrator=scheme)
    excess = np.sin(angle) - ROLLING / R * np.cos(angle)
    speed = max(0.0, excess) * G / 1.5 * DURATION
    assert motion["disc.vx"][-1].item() == pytest.approx(speed, abs=1e-9)


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("shape", ["Sphere", "Capsule"])
def test_rolling_ball_decelerates(scheme, shape):
    """In any direction, without turning aside."""
    direction = np.array([0.6, -0.8, 0.0])
    axis = np.cross([0.0, 0.0, 1.0], direction)
    model = ball(tuple(direction), tuple(axis / R), shape)
    motion = da.solve_nonsmooth(model, 0.1, step=STEP, integrator=scheme)
    speed = 1 - ROLLING / R * G / 1.4 * 0.1
    final = [motion[f"ball.v{axis}"][-1].item() for axis in "xyz"]
    np.testing.assert_allclose(final, speed * direction, atol=1e-6 if shape == "Capsule" else 1e-9)


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_spinning_ball_decelerates_and_stops(scheme):
    rate = SPINNING * M * G / (0.4 * M * R**2)
    motion = da.solve_nonsmooth(ball((0, 0, 0), (0, 0, 2.0)), 0.1, step=STEP, integrator=scheme)
    spin = motion.trajectory.v[5]
    np.testing.assert_allclose(spin, np.maximum(2.0 - rate * motion.time, 0.0), atol=1e-9)


def test_friction_impulses_are_those_of_slip():
    """The moment of rolling friction is no part of them."""
    motion = da.solve_nonsmooth(disc(1.0, -1.0 / R), 0.1, step=STEP)
    force = M * ROLLING / R * G / 1.5
    assert motion.data["friction_impulse"].sum().item() == pytest.approx(force * 0.1, rel=1e-8)
    (contact,) = motion.contact_forces(0.05).forces
    assert contact == pytest.approx([-force, M * G], rel=1e-8)


@pytest.mark.thorough
def test_gradient_by_the_coefficient():
    motion = da.solve_nonsmooth(
        disc(1.0, -1.0 / R), DURATION, step=STEP, integrator=da.MoreauJean()
    )
    for method in ("direct", "adjoint"):
        slope = da.sensitivity(motion, da.final("disc.x"), method=method).item()
        assert slope == pytest.approx(-G / R / 1.5 * DURATION**2 / 2, rel=1e-8)


def test_pairs_have_their_own_rolling_friction():
    system = da.System("two", gravity=(0, -G))
    shapes = {"ground": [planar.contact.HalfPlane(system.ground)]}
    for k, name in enumerate(("hard", "soft")):
        start = {"position": (k, R), "velocity": (1.0, 0), "angular_velocity": -1 / R}
        body = planar.Body(name, mass=M, inertia=M * R**2 / 2, **start)
        shapes[name] = [planar.contact.Circle(system.add(body), R)]
    pairs = [planar.contact.Pair(("soft", "ground"), rolling=ROLLING)]
    system.add(planar.Collisions("floor", shapes, friction=0.5, pairs=pairs))
    motion = da.solve_nonsmooth(system.build(), 0.1, step=STEP)
    assert motion["hard.vx"][-1].item() == pytest.approx(1.0, abs=1e-10)
    slower = 1 - ROLLING / R * G / 1.5 * 0.1
    assert motion["soft.vx"][-1].item() == pytest.approx(slower, abs=1e-9)


def test_nothing_spins_in_the_plane():
    system = da.System("plane")
    body = system.add(planar.Body("disc", mass=M, inertia=1.0))
    shapes = [planar.contact.Circle(body, R)]
    with pytest.raises(ModelError, match=r"floor\.spinning: nothing spins about a normal"):
        planar.Collisions("floor", shapes, spinning=0.1)
    system.add(planar.Collisions("floor", shapes, rolling=-1))
    with pytest.raises(ModelError, match=r"floor\.rolling: is -1 m"):
        system.build()
