"""A projectile over level ground: time of flight and range are closed forms, so are derivatives.

Meriam and Kraige, Engineering Mechanics: Dynamics, the motion of projectiles.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar


@pytest.mark.parametrize("terminal", [True, False])
def test_projectile(terminal):
    """From height h: ``t* = (v_y + √(v_y² + 2 g h))/g``, range ``v_x t*``; RK4 is exact."""
    g, h, vx, vy = 9.81, 1.3, 2.0, 3.1
    system = da.System("projectile")
    inputs = {"h": h, "vx": vx, "vy": vy, "g": g}
    p = {n: system.parameter(n, v) for n, v in inputs.items()}
    start = {"position": (0, p["h"]), "velocity": (p["vx"], p["vy"])}
    ball = system.add(planar.Particle("ball", mass=1.0, **start))
    system.add(planar.Force("weight", ball.center, (0.0, -p["g"])))
    hit = da.Event(ball.y, terminal=terminal, direction=-1)
    motion = da.solve_dynamics(system.build(), 1.5, step=0.0173, events={"hit": hit})
    root = np.sqrt(vy**2 + 2 * g * h)
    time = (vy + root) / g
    by = np.array([1 / root, 0.0, time / root, -time / g + h / (g * root)])
    listed = [da.event_time("hit"), da.at_event("hit", ball.x), da.at_event("hit", "ball.vy")]
    expected = [by, vx * by + [0, time, 0, 0], -np.array([g, 0, vy, h]) / root]
    values = [time, vx * time, -root]
    if terminal:
        area = h * time + vy * time**2 / 2 - g * time**3 / 6
        by_area = np.array([time, 0, time**2 / 2, -(time**3) / 6])  # the height at t* is zero
        listed += [da.final("ball.x"), da.integral("ball.y"), da.mean("ball.y")]
        values += [vx * time, area, area / time]
        expected += [expected[1], by_area, by_area / time - area / time**2 * by]
        listed += [da.rms("t - t + 2"), da.maximum("ball.x")]
        values += [2.0, vx * time]
        expected += [np.zeros(4), expected[1]]
    for method in ("adjoint", "direct"):
        gradient = da.sensitivity(motion, listed, method=method)
        np.testing.assert_allclose(gradient, expected, rtol=1e-10, atol=1e-10)
    gradient = [da.evaluate(motion, response) for response in listed]
    np.testing.assert_allclose(gradient, values, rtol=1e-11)
