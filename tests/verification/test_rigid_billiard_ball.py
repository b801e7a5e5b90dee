"""A rigid ball that slides with any spin until it rolls, and one that bounces (Coriolis 1835).

Sliding, the velocity ``u`` of the point that touches keeps its direction and falls by ``7/2 μ g``;
so the path is a parabola, and after ``2 |u|/(7 μ g)`` the ball rolls on with ``v = v₀ − 2/7 u₀``.
A bounce changes ``v`` by ``−min(μ (1 + e) w, 2/7 |u|) u/|u|``, ``w`` the speed of approach.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial

RADIUS, MASS, ROUGH, G = 0.03, 0.2, 0.3, 9.81
SPEED, SPIN = np.array([1.2, -0.3, 0.0]), np.array([20.0, -35.0, 10.0])
SLIP = SPEED + np.cross(SPIN, (0, 0, -RADIUS))
ROLLS = 2 * np.linalg.norm(SLIP) / (7 * ROUGH * G)


def ball(
    speed=SPEED, spin=SPIN, height: float = 0.0, restitution: float = 0.0, poisson: bool = False
) -> da.Model:
    system = da.System("ball", gravity=(0, 0, -G))
    rough, along = system.parameter("mu", ROUGH), system.parameter("vx", speed[0])
    sphere = system.add(
        spatial.Sphere(
            "ball",
            mass=MASS,
            radius=RADIUS,
            position=(0, 0, RADIUS + height),
            velocity=(along, speed[1], speed[2]),
            angular_velocity=tuple(spin),
        )
    )
    v, w = sphere.velocity, sphere.angular_velocity
    slips = v[0] - w[1] * RADIUS, v[1] + w[0] * RADIUS
    law = {"restitution": restitution, "friction": rough, "poisson": poisson}
    system.add(spatial.UnilateralConstraint("cloth", sphere.z - RADIUS, slips, **law))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("options", "near"), [({"integrator": da.DormandPrince(1e-9, 1e-11)}, 1e-10), ({}, 1e-5)]
)
def test_path_and_rolling(options, near):
    motion = da.solve_dynamics(ball(), 1.5 * ROLLS, step=0.01, **options)
    assert motion.status.success and not motion.warnings
    half = 0.5 * ROLLS
    bend = SLIP / np.linalg.norm(SLIP) * ROUGH * G
    computed = motion.at([half])["ball.position"].values[0]
    np.testing.assert_allclose(computed[:2], (SPEED * half - bend * half**2 / 2)[:2], atol=near)
    np.testing.assert_allclose(motion["ball.velocity"].values[-1], SPEED - 2 / 7 * SLIP, atol=near)
    assert np.linalg.norm(motion["cloth.slip"].values[-1]) < 1e-12


@pytest.mark.thorough
def test_a_bowling_ball_rolls_at_five_sevenths():
    """Thrown without spin; the way it rolls, and how that depends on friction and speed."""
    speed, time = np.array([3.0, 0.0, 0.0]), 1.0
    model = ball(speed, (0, 0, 0))
    motion = da.solve_dynamics(model, time, integrator=da.DormandPrince(1e-9, 1e-11))
    assert motion["ball.velocity"].values[-1][0] == pytest.approx(5 / 7 * 3.0, rel=1e-11)
    rolls = 2 * 3.0 / (7 * ROUGH * G)
    way = 5 / 7 * 3.0 * time + 3.0 * rolls / 7
    assert motion.values("ball.x")[-1] == pytest.approx(way, rel=1e-10)
    response = da.final(model["ball.x"])
    wanted = [-3.0 * rolls / 7 / ROUGH, 5 / 7 * time + 2 * rolls / 7]
    for method in ("direct", "adjoint"):
        derivative = da.sensitivity(motion, response, method=method).values.ravel()
        np.testing.assert_allclose(derivative, wanted, rtol=1e-8)


@pytest.mark.few(2)
@pytest.mark.parametrize(
    "scheme", [da.AnticipatedImpacts(), da.MoreauJean()], ids=lambda s: type(s).__name__
)
@pytest.mark.parametrize("spin", [0.0, 70.0, 140.0])
def test_back_spin_in_steps(spin, scheme):
    """A sphere on a plane as shapes rolls on with ``5/7 v₀ − 2/7 R ω₀``, also backwards."""
    system = da.System("draw shot", gravity=(0, 0, -G))
    at = {"position": (0, 0, RADIUS), "velocity": (1.0, 0, 0)}
    sphere = spatial.Sphere("ball", mass=MASS, radius=RADIUS, angular_velocity=(0, -spin, 0), **at)
    shapes = [
        spatial.contact.Sphere(system.add(sphere).center, RADIUS),
        spatial.contact.HalfSpace(system.ground.frame(axis=(0, 0, 1))),
    ]
    system.add(spatial.Collisions("cloth", shapes, friction=ROUGH))
    rolls = 2 * (1.0 + spin * RADIUS) / (7 * ROUGH * G)
    motion = da.solve_nonsmooth(system.build(), 1.05 * rolls, step=rolls / 80, integrator=scheme)
    assert motion.status.success
    end = 5 / 7 - 2 / 7 * RADIUS * spin
    assert motion.values("ball.vx")[-1] == pytest.approx(end, abs=1e-9)
    assert motion.values("ball.angular_velocity")[-1, 1] == pytest.approx(end / RADIUS, abs=1e-7)


@pytest.mark.few(1)
@pytest.mark.parametrize("fall", [0.5, 4.0])
@pytest.mark.parametrize("poisson", [False, True])
def test_bounces_slide_or_stick(fall, poisson):
    speed = np.array([1.2, -0.3, -fall])
    model = ball(speed, height=1e-9, restitution=0.6, poisson=poisson)
    motion = da.solve_dynamics(model, 0.02, integrator=da.DormandPrince())
    computed, (first,) = motion["ball.velocity"].values[-1], motion.impacts
    speed_change = min(ROUGH * 1.6 * fall, 2 / 7 * np.linalg.norm(SLIP))
    wanted = speed - speed_change * SLIP / np.linalg.norm(SLIP)
    np.testing.assert_allclose(computed[:2], wanted[:2], atol=1e-7)
    assert first.normal == pytest.approx(MASS * 1.6 * fall, rel=1e-6)
    assert np.linalg.norm(first.tangential) == pytest.approx(MASS * speed_change, rel=1e-6)
