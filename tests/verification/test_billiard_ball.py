"""A ball that slides with any spin until it rolls (Coriolis 1835).

The velocity ``u`` of the point that touches keeps its direction and falls by ``7/2 μ g``; so the
path is a parabola, and after ``2 |u|/(7 μ g)`` the ball rolls on with ``v = v₀ − 2/7 u₀``.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial

kit = spatial.contact
RADIUS, MASS, ROUGH, G = 0.03, 0.2, 0.3, 9.81
SPEED, SPIN = np.array([1.2, -0.3, 0.0]), np.array([20.0, -35.0, 10.0])
SLIP = SPEED + np.cross(SPIN, (0, 0, -RADIUS))
ROLLS = 2 * np.linalg.norm(SLIP) / (7 * ROUGH * G)


@pytest.mark.few(1)
@pytest.mark.parametrize("moving", [None, "x"])
def test_path_and_rolling(moving):
    """Friction of a direction that changes with the ball, on a plane that stands any way."""
    axes = np.eye(3) if moving is None else np.roll(np.eye(3), 1, axis=0)
    up = axes @ (0, 0, 1)
    depth = 1e-6
    system = da.System("ball", gravity=tuple(-G * up))
    ball = spatial.Sphere(
        "ball",
        mass=MASS,
        radius=RADIUS,
        position=tuple((RADIUS - depth) * up),
        velocity=tuple(axes @ SPEED),
        angular_velocity=tuple(axes @ SPIN),
    )
    ball = system.add(ball)
    system.add(
        spatial.Contact(
            "cloth",
            kit.HalfSpace(system.ground.frame(axis=tuple(up))),
            kit.Sphere(ball.center, RADIUS),
            law=kit.KelvinVoigt(stiffness=MASS * G / depth, damping=500.0),
            friction=kit.Coulomb(ROUGH, slip_speed=1e-3),
        )
    )
    integrator = da.Radau(rtol=1e-7, atol=1e-10)
    motion = da.solve_dynamics(system.build(), 1.5 * ROLLS, integrator=integrator)
    assert motion.status.success
    half = motion.at([0.5 * ROLLS])
    bend = SLIP / np.linalg.norm(SLIP) * ROUGH * G
    place = axes.T @ half["ball.position"].values[0]
    wanted = SPEED * 0.5 * ROLLS - bend * (0.5 * ROLLS) ** 2 / 2
    np.testing.assert_allclose(place[:2], wanted[:2], atol=1e-6)
    velocity = axes.T @ motion["ball.velocity"].values[-1]
    np.testing.assert_allclose(velocity[:2], (SPEED - 2 / 7 * SLIP)[:2], atol=1e-4)
    assert motion["cloth.friction_force"].values[0] == pytest.approx(ROUGH * MASS * G, rel=1e-4)
    assert motion["cloth.slip"].values[-1] < 1e-5
