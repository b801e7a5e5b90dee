"""How far a plan is from a motion, interval by interval.

From every knot the equations of motion are integrated to the next one under the controls found. The
distance to the plan there is what collocation has left out, also where a run over the whole time
would lose its way because the mechanism is unstable.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np

from dalembert.design.trajectory.control import Control
from dalembert.design.trajectory.physics import Physics
from dalembert.results.recording import Trajectory

STEPS = 16
"""Runge–Kutta steps in an interval."""


def largest_defect(
    physics: Physics, plan: Trajectory, controls: Mapping[str, Control], q: np.ndarray
) -> float:
    """Largest distance at the ends of intervals, in natural sizes."""
    flow = _Flow(physics, controls, q, plan.t.size - 1)
    h = (plan.t[-1] - plan.t[0]) / (plan.t.size - 1) / STEPS
    t, y, v = plan.t[:-1].copy(), plan.y[:, :-1], plan.v[:, :-1]
    for _ in range(STEPS):
        k1 = flow(t, y, v)
        k2 = flow(t + h / 2, *_ahead(y, v, k1, h / 2))
        k3 = flow(t + h / 2, *_ahead(y, v, k2, h / 2))
        k4 = flow(t + h, *_ahead(y, v, k3, h))
        mean = [(a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(k1, k2, k3, k4, strict=True)]
        (y, v), t = _ahead(y, v, mean, h), t + h
    manifold, sizes = physics.equations.manifold, physics.model.scales.displacements
    off = np.abs(manifold.lead(plan.y[:, 1:], y)) / sizes[:, None]
    return float(np.max(off, initial=0.0)) if np.all(np.isfinite(off)) else float("inf")


def _ahead(y: np.ndarray, v: np.ndarray, rates: list, h: float) -> tuple[np.ndarray, np.ndarray]:
    return y + h * rates[0], v + h * rates[1]


class _Flow:
    """``t, y, v → ẏ, v̇`` of many states, in columns."""

    def __init__(
        self, physics: Physics, controls: Mapping[str, Control], q: np.ndarray, count: int
    ):
        e = physics.equations
        self.controls, self.speeds = controls, e.speed_count
        self.q = np.tile(np.reshape(q, (-1, 1)), count)
        self.rate = ca.Function("rate", [e.y, e.v], [e.pose_rate]).map(count)
        self.solvable = physics.solvable.map(count)

    def __call__(self, t: np.ndarray, y: np.ndarray, v: np.ndarray) -> list[np.ndarray]:
        u = np.array([control(t) for control in self.controls.values()]).reshape(-1, t.size)
        matrices, rest = (part.full() for part in self.solvable(t, y, v, u, self.q))
        blocks = np.split(matrices, t.size, axis=1)
        found = np.linalg.solve(np.array(blocks), -rest.T[:, :, None])[:, : self.speeds, 0]
        return [self.rate(y, v).full(), found.T]
