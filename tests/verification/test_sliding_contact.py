"""Sliding by Coulomb's law, in closed form.

Down a slope ``a = g (sin α − μ cos α)``, and nothing moves where ``tan α ≤ μ``; a sphere that is
set down sliding rolls at ``5 v0/7`` from ``t = 2 v0/(7 μ g)`` on.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

G, SLOPE = 9.81, np.radians(30)


@pytest.mark.few(2)
@pytest.mark.parametrize("friction", [0.0, 0.3, 0.57, 0.58])
def test_slope(friction):
    system = da.System("slope", gravity=(G * np.sin(SLOPE), -G * np.cos(SLOPE)))
    block = system.add(planar.Particle("block", mass=2.0, position=(0, 0)))
    system.add(
        planar.UnilateralConstraint("slope", block.y, block.vx, restitution=0.5, friction=friction)
    )
    motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    a = max(G * (np.sin(SLOPE) - friction * np.cos(SLOPE)), 0.0)
    assert motion.values("block.x")[-1] == pytest.approx(a / 2, rel=1e-12)
    assert motion.values("slope.normal_force")[-1] == pytest.approx(2 * G * np.cos(SLOPE))
    rubs = 2 * min(friction * G * np.cos(SLOPE), G * np.sin(SLOPE))
    assert motion.values("slope.friction_force")[-1] == pytest.approx(-rubs, rel=1e-12)


def test_sliding_to_rolling():
    radius, speed, friction = 0.2, 3.0, 0.25
    system = da.System("bowling", gravity=(0, -G))
    v = system.parameter("v", speed)
    inertia = 2 / 5 * 7.0 * radius**2
    ball = system.add(
        planar.Body("ball", mass=7.0, inertia=inertia, position=(0, radius), velocity=(v, 0))
    )
    slip = ball.vx + radius * ball.angular_velocity
    system.add(
        planar.UnilateralConstraint("lane", ball.y - radius, slip, restitution=0, friction=friction)
    )
    model = system.build()
    motion = da.solve_dynamics(model, 1.0, step=0.01)
    steps, kernel = motion.record.steps, motion.record.kernel
    ((k, _),) = kernel.crossings(steps)
    time = 2 * speed / (7 * friction * G)
    assert steps.t[k] == pytest.approx(time, rel=1e-13)
    assert motion.values("ball.vx")[-1] == pytest.approx(5 / 7 * speed, rel=1e-13)
    # x = v t_r − μ g t_r²/2 + 5/7 v (T − t_r), with t_r in proportion to v
    slope = 5 / 7 + 2 * time * (1 - 5 / 7) - friction * G * time**2 / speed
    for method in ("direct", "adjoint"):
        derivative = da.sensitivity(motion, da.final(model["ball.x"]), method=method).item()
        assert derivative == pytest.approx(slope, rel=1e-12)


def test_two_corners_share_a_load_until_both_slide():
    """A push that grows by 1 N/s moves a box at ``μ m g``, however corners share the friction."""
    system = da.System("pushed", gravity=(0, -G))
    mu, end = system.parameter("mu", 0.5), 6.0
    box = system.add(planar.Body("box", mass=1.0, inertia=0.01, position=(0, 0.1)))
    for k, x in enumerate((-0.15, 0.15)):
        corner = box.point(x, -0.1)
        law = {"restitution": 0.3, "friction": mu}
        system.add(planar.UnilateralConstraint(f"c{k}", corner.y, corner.velocity[0], **law))
    system.add(planar.Force("push", box.center, (da.t, 0)))
    model = system.build()
    motion = da.solve_dynamics(model, end, step=0.01)
    slides = end - 0.5 * G
    assert motion.values("box.x")[-1] == pytest.approx(slides**3 / 6, rel=1e-12)
    resting = motion.time < 0.5 * G
    shared = motion.values("c0.friction_force") + motion.values("c1.friction_force")
    np.testing.assert_allclose(shared[resting], -motion.time[resting], atol=1e-12)
    for method in ("direct", "adjoint"):
        derivative = da.sensitivity(motion, da.final(model["box.x"]), method=method).item()
        assert derivative == pytest.approx(-(slides**2) / 2 * G, rel=1e-11)
