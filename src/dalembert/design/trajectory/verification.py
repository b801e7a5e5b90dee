"""Verification of a plan by forward runs under its controls, per interval and as a whole.

From every knot the equations of motion are integrated to the next one under the optimal controls.
The distance to the plan there is the discretisation error of the collocation, which is also
meaningful if the mechanism is unstable and a run over the whole time would diverge.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca
import numpy as np

from dalembert.design.trajectory.control import Control
from dalembert.design.trajectory.method import TrajectoryMethod
from dalembert.design.trajectory.optimal import OptimalTrajectory
from dalembert.design.trajectory.physics import Physics
from dalembert.errors import AnalysisError
from dalembert.model.scheduled import ScheduledModel
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory

STEPS = 16
"""Number of Runge–Kutta steps per interval."""


def verify_plan(
    plan: OptimalTrajectory, physics: Physics, method: TrajectoryMethod, from_start: bool
) -> OptimalTrajectory:
    """The plan with the forward motion under its controls, and their distances.

    Parameters
    ----------
    from_start : whether the plan starts at the initial state of the model
    """
    q = np.array(list(plan.x.values()))
    defect = largest_defect(physics, plan.planned.trajectory, plan.controls, q)
    try:
        motion = _forward(plan.planned, method, from_start)
    except AnalysisError as error:  # the run cannot start there; the plan is still returned
        status = replace(plan.status, message=f"{plan.status.message}; not run forward: {error}")
        return replace(plan, defect=defect, status=status)
    return replace(
        plan,
        motion=motion,
        defect=defect,
        deviation=_deviation(plan.planned, motion),
        step_error=_deviation(motion, _forward(plan.planned, method, from_start, 2)),
    )


def _forward(planned: Motion, method: TrajectoryMethod, from_start: bool, finer: int = 1) -> Motion:
    """Forward motion under the controls of a plan, with steps divided by ``finer``."""
    model, s = planned.model, planned.trajectory
    assert isinstance(model, ScheduledModel)
    initial = model if from_start else model.begun_at(s.y[:, 0], s.v[:, 0], planned.parameters)
    run = method.forward(float(planned.time[-1]))
    if finer > 1:
        assert isinstance(run.step, float)
        run = replace(run, step=run.step / finer)
    return run.run(initial, planned.parameters)


def _deviation(planned: Motion, motion: Motion) -> float:
    """Largest distance at the instants of the first motion; NaN if a motion ends early."""
    if not (motion.status.success and planned.status.success):
        return float("nan")
    positions = motion.trajectory.y[:, :: (motion.time.size - 1) // (planned.time.size - 1)]
    e, s = planned.model.equations, planned.model.scales
    distance = e.manifold.lead(planned.trajectory.y, positions)
    return float(np.max(np.abs(distance) / s.displacements[:, None], initial=0.0))


def largest_defect(
    physics: Physics, plan: Trajectory, controls: Mapping[str, Control], q: np.ndarray
) -> float:
    """Largest distance of plan and integration at the ends of intervals, in natural sizes."""
    flow = _Flow(physics, controls, q, plan.t.size - 1)
    h = (plan.t[-1] - plan.t[0]) / (plan.t.size - 1) / STEPS
    t, y, v = plan.t[:-1].copy(), plan.y[:, :-1], plan.v[:, :-1]
    for _ in range(STEPS):
        k1 = flow(t, y, v)
        k2 = flow(t + h / 2, *_advance(y, v, k1, h / 2))
        k3 = flow(t + h / 2, *_advance(y, v, k2, h / 2))
        k4 = flow(t + h, *_advance(y, v, k3, h))
        mean_rate = [(a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(k1, k2, k3, k4, strict=True)]
        (y, v), t = _advance(y, v, mean_rate, h), t + h
    manifold, sizes = physics.equations.manifold, physics.model.scales.displacements
    distance = np.abs(manifold.lead(plan.y[:, 1:], y)) / sizes[:, None]
    return float(np.max(distance, initial=0.0)) if np.all(np.isfinite(distance)) else float("inf")


def _advance(y: np.ndarray, v: np.ndarray, rates: list, h: float) -> tuple[np.ndarray, np.ndarray]:
    return y + h * rates[0], v + h * rates[1]


class _Flow:
    """Right-hand side ``t, y, v → ẏ, v̇`` of many states, in columns."""

    def __init__(
        self, physics: Physics, controls: Mapping[str, Control], q: np.ndarray, count: int
    ):
        e = physics.equations
        self.controls, self.speeds = controls, e.speed_count
        self.q = np.tile(np.reshape(q, (-1, 1)), count)
        self.rate = ca.Function("rate", [e.y, e.v], [e.pose_rate]).map(count)
        self.linear_system = physics.linear_system.map(count)

    def __call__(self, t: np.ndarray, y: np.ndarray, v: np.ndarray) -> list[np.ndarray]:
        u = np.array([control(t) for control in self.controls.values()]).reshape(-1, t.size)
        matrices, residual = (part.full() for part in self.linear_system(t, y, v, u, self.q))
        blocks = np.split(matrices, t.size, axis=1)
        solution = np.linalg.solve(np.array(blocks), -residual.T[:, :, None])[:, : self.speeds, 0]
        return [self.rate(y, v).full(), solution.T]
