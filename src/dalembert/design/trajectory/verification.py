"""Verification of a plan by forward runs under its controls, and refinement of the plan.

From every knot the equations of motion are integrated to the next one under the optimal controls.
The distance to the plan there is the discretisation error of the collocation, which is also
meaningful if the mechanism is unstable and a run over the whole time would diverge.

A control that enters linearly and is not determined by the optimality conditions (a singular arc)
may alternate at every node: it chatters. Polynomials through alternating nodes satisfy the
equations of motion at the collocation points only, so that the objective of such a plan is lower
than that of any motion. A penalty on the second differences of the controls prevents it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca
import numpy as np

from dalembert.design.trajectory.control import Control
from dalembert.design.trajectory.method import TrajectoryMethod
from dalembert.design.trajectory.physics import Physics
from dalembert.design.trajectory.trajectory_result import TrajectoryResult
from dalembert.design.trajectory.transcription import Transcription
from dalembert.errors import AnalysisError
from dalembert.model.graph.scheduled import ScheduledModel
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.results.status import Outcome, Status

STEPS = 16
"""Number of Runge–Kutta steps per interval."""
REFINEMENTS = 3
"""Upper limit of refined plans, each with twice as many intervals or with smoother controls."""
HARMLESS = 1e-5
"""Threshold for harmful chattering: distance of plan and run, in natural sizes."""
MIN_STEP = 0.05
"""Threshold for steps of a control that are counted, relative to its range."""
MAX_DISTANCE = 3
"""Upper limit of nodes between two reversals of the same chattering."""
MAX_REVERSALS = 5
"""Upper limit of close reversals of a control that does not chatter."""
ROUGHNESS_WEIGHT = 1e-3
"""Penalty on the roughness of controls, relative to the objective."""


def verify_plan(
    plan: TrajectoryResult, physics: Physics, method: TrajectoryMethod, from_start: bool
) -> TrajectoryResult:
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


def reversals(control: Control) -> int:
    """Number of changes between rising and falling in close succession."""
    steps = np.diff(control.values)
    large = np.flatnonzero(np.abs(steps) > MIN_STEP * float(np.ptp(control.values)))
    if large.size < 2:
        return 0
    turns = large[1:][np.sign(steps[large[1:]]) != np.sign(steps[large[:-1]])]
    return int(np.count_nonzero(np.diff(turns) <= MAX_DISTANCE))


def chattering(controls: dict[str, Control]) -> dict[str, int]:
    """Name → reversals of the controls that chatter."""
    counts = {name: reversals(control) for name, control in controls.items()}
    return {name: count for name, count in counts.items() if count > MAX_REVERSALS}


def roughness(transcription: Transcription) -> ca.MX:
    """``Σ (Δ²u)²`` over the nodes, with controls scaled by their bounds."""
    ends, middles = (transcription.blocks[name].symbol for name in ("u", "u_middle"))
    inner = ends[:, :-1] - 2 * middles + ends[:, 1:]
    outer = middles[:, :-1] - 2 * ends[:, 1:-1] + middles[:, 1:]
    return ca.sumsqr(inner) + ca.sumsqr(outer)


def agrees(plan: TrajectoryResult, accuracy: float) -> bool:
    """Whether the forward run reaches the plan and is converged with respect to its steps."""
    return bool(plan.deviation <= accuracy and plan.step_error <= accuracy)


def exploits_nodes(plan: TrajectoryResult) -> bool:
    """Whether controls chatter and the forward run deviates from the plan."""
    return bool(chattering(plan.controls)) and not agrees(plan, HARMLESS)


def with_final_status(plan: TrajectoryResult, accuracy: float, smoothed: bool) -> TrajectoryResult:
    """The plan with the status of the verification run, and warnings."""
    warnings = [*plan.warnings]
    if smoothed:
        warnings.append(
            "the control of the first plan chattered, and the run under it missed the plan: a "
            "small penalty on second differences smooths it; the objective does not contain it"
        )
    for name, count in chattering(plan.controls).items():
        warnings.append(
            f"{name} chatters: {count} reversals from node to node; a term such as "
            "da.integral of its square in the objective prevents this"
        )
    plan = replace(plan, warnings=warnings)
    if not plan.success or agrees(plan, accuracy):
        return plan
    if plan.motion is None:
        reason = plan.status.message
    elif not np.isfinite(plan.deviation):
        reason = f"the run under the controls fails: {plan.motion.status}"
    elif plan.deviation > accuracy:
        reason = (
            f"the run under the controls is {plan.deviation:.2g} natural sizes away from the plan "
            f"on {plan.intervals} intervals, more than accuracy = {accuracy:g}"
        )
    else:
        reason = (
            f"the run under the controls changes by {plan.step_error:.2g} natural sizes with half "
            f"of its steps, more than accuracy = {accuracy:g}"
        )
    cure = "give more intervals or steps, or a larger accuracy where the motion is unstable"
    status = Status(Outcome.NOT_CONVERGED, f"{reason}; {cure}", plan.duration, plan.status.residual)
    return replace(plan, status=status)
