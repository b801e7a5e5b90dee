"""A knife edge on an inclined plane: it does not run down, but along a cycloid.

Source: J. I. Neimark, N. A. Fufaev, *Dynamics of Nonholonomic Systems*, 1972: started at rest
across the slope and turning at ω, with a = g sin α,

    x = a sin²(ωt) / 2ω²  (down the slope),   y = a (2ωt − sin 2ωt) / 4ω²  (across it).
"""

from __future__ import annotations

import numpy as np

import dalembert as da
from dalembert import spatial

MASS, SLOPE, TURNING, G = 1.5, 0.3, 2.0, 9.81


def skate() -> da.Model:
    """Gravity leans instead of the plane; x points down the slope."""
    lean = (G * np.sin(SLOPE), 0.0, -G * np.cos(SLOPE))
    system = da.System("knife edge", gravity=lean)
    body = spatial.Body(
        "skate",
        mass=MASS,
        inertia=(0.01, 0.03, 0.02),
        position=(0, 0, 0),
        rotation=da.rotation.identity(),
        velocity=(0, 0, 0),
        angular_velocity=(0, 0, TURNING),
    )
    system.add(body)
    plane = system.ground.frame()
    system.add(spatial.Planar("plane", plane, body.frame()))
    system.add(spatial.KnifeEdge("edge", body.frame(), plane))
    return system.build()


def test_cycloid_and_force():
    motion = da.solve_dynamics(
        skate(), 4.0, integrator=da.DormandPrince853(1e-11, 1e-11), outputs=41
    )
    assert motion.status.success
    angle, pull = TURNING * motion.time, G * np.sin(SLOPE)
    x = pull * np.sin(angle) ** 2 / (2 * TURNING**2)
    y = pull * (2 * angle - np.sin(2 * angle)) / (4 * TURNING**2)
    np.testing.assert_allclose(motion["skate.x"], x, atol=1e-9)
    np.testing.assert_allclose(motion["skate.y"], y, atol=1e-9)
    across = np.column_stack([-np.sin(angle), np.cos(angle)])
    force = 2 * MASS * pull * np.sin(angle)  # m v ω − m a·b, with v = a sin(ωt)/ω
    np.testing.assert_allclose(motion["edge.force"][:, :2], force[:, None] * across, atol=1e-7)
    np.testing.assert_allclose(motion["plane.force"][:, 2], MASS * G * np.cos(SLOPE), atol=1e-7)
    np.testing.assert_allclose(motion["energy"] - motion["energy"][0], 0.0, atol=1e-9)
