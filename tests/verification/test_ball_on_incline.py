"""A ball released on an incline rolls if ``tan α < 7/2 μ``, and slips otherwise (closed form).

Rolling, ``a = 5/7 g sin α``; slipping, ``a = g (sin α − μ cos α)`` and ``ω̇ = 5 μ g cos α/(2 R)``.
By contact that is located, by many-body contact in fixed steps, and by a compliant law.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial

G, RADIUS, MASS, ANGLE, TIME = 9.81, 0.05, 0.3, math.radians(25), 0.8
LIMIT = 2 / 7 * math.tan(ANGLE)
"""Coefficient of friction above which the ball rolls."""


def release(rough: float, contact: str) -> da.Motion:
    """Along x of the incline, with gravity turned; the result after 0.8 s."""
    system = da.System("incline")
    angle = system.parameter("angle", ANGLE, "rad")
    friction = system.parameter("friction", rough)
    system.gravity(G * da.sin(angle), 0.0, -G * da.cos(angle))
    kit = spatial.contact
    sunk = MASS * G * math.cos(ANGLE) / 1e6 if contact == "compliant" else 0.0
    ball = spatial.Sphere(
        "ball",
        mass=MASS,
        radius=RADIUS,
        position=(0, 0, RADIUS - sunk),
        velocity=(0, 0, 0),
        angular_velocity=(0, 0, 0),
    )
    system.add(ball)
    plane = kit.HalfSpace(system.ground.frame(axis=(0, 0, 1)))
    round_ = kit.Sphere(ball.center, RADIUS)
    if contact == "located":
        v, w = ball.velocity, ball.angular_velocity
        slips = v[0] - RADIUS * w[1], v[1] + RADIUS * w[0]
        law = {"restitution": 0.0, "friction": friction}
        system.add(spatial.UnilateralConstraint("plane", ball.z - RADIUS, slips, **law))
        return da.solve_dynamics(system.build(), TIME, integrator=da.DormandPrince(1e-9, 1e-11))
    if contact == "compliant":
        law = {"law": kit.KelvinVoigt(stiffness=1e6, damping=300.0)}
        law["friction"] = kit.Coulomb(friction, slip_speed=1e-4)
        system.add(spatial.Contact("plane", plane, round_, **law))
        return da.solve_dynamics(system.build(), TIME, integrator=da.Radau(1e-8, 1e-11))
    shapes = [plane, round_]
    system.add(spatial.Collisions("plane", shapes, restitution=0.0, friction=friction))
    return da.solve_nonsmooth(system.build(), TIME, step=2e-3)


def law(rough: float) -> tuple[float, float]:
    """Acceleration of the ball and of its rotation."""
    if rough >= LIMIT:
        return 5 / 7 * G * math.sin(ANGLE), 5 / 7 * G * math.sin(ANGLE) / RADIUS
    slipping = G * (math.sin(ANGLE) - rough * math.cos(ANGLE))
    return slipping, 5 * rough * G * math.cos(ANGLE) / (2 * RADIUS)


@pytest.mark.thorough
@pytest.mark.parametrize("share", [0.3, 0.97, 1.03, 2.0])
@pytest.mark.parametrize(
    ("contact", "near"), [("located", 1e-10), ("compliant", 1e-4), ("Collisions", 1e-12)]
)
def test_speed_and_spin(contact, near, share):
    """Of the stated share of the coefficient at which the ball begins to roll."""
    motion, (along, turning) = release(share * LIMIT, contact), law(share * LIMIT)
    assert motion.status.success
    speed = motion["ball.velocity"].values[-1, 0]
    spin = motion["ball.angular_velocity"].values[-1, 1]
    np.testing.assert_allclose([speed, spin], [along * TIME, turning * TIME], rtol=near)


@pytest.mark.few(1)
@pytest.mark.parametrize("share", [0.3, 2.0])
def test_gradients(share):
    motion = release(share * LIMIT, "located")
    gradient = da.sensitivity(motion, da.final("ball.x"), wrt=["angle", "friction"])
    cos, sin, half = math.cos(ANGLE), math.sin(ANGLE), G * TIME**2 / 2
    rolls = [5 / 7 * half * cos, 0.0]
    slips = [half * (cos + share * LIMIT * sin), -half * cos]
    np.testing.assert_allclose(gradient.values[0], rolls if share > 1 else slips, atol=1e-9)
