"""Agreement of a plan with the forward run under its controls, and refinement of the plan.

A control that enters linearly and is not determined by the optimality conditions (a singular arc)
may alternate at every node: it chatters. Polynomials through alternating nodes satisfy the
equations of motion at the collocation points only, so that the objective of such a plan is lower
than that of any motion. A penalty on the second differences of the controls prevents it.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from dalembert.design.trajectory.control import Control
from dalembert.design.trajectory.optimal import OptimalTrajectory
from dalembert.design.trajectory.transcription import Transcription
from dalembert.results.status import Outcome, Status

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


def agrees(plan: OptimalTrajectory, accuracy: float) -> bool:
    """Whether the forward run reaches the plan and is converged with respect to its steps."""
    return bool(plan.deviation <= accuracy and plan.step_error <= accuracy)


def exploits_nodes(plan: OptimalTrajectory) -> bool:
    """Whether controls chatter and the forward run deviates from the plan."""
    return bool(chattering(plan.controls)) and not agrees(plan, HARMLESS)


def with_final_status(
    plan: OptimalTrajectory, accuracy: float, smoothed: bool
) -> OptimalTrajectory:
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
