"""Whether a plan agrees with the run under its controls, and what to change where it does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.design.trajectory.chattering import chattering
from dalembert.design.trajectory.optimal import OptimalTrajectory
from dalembert.results.status import Outcome, Status

REFINEMENTS = 3
"""Upper limit of plans that follow the first one, each on twice as many intervals or smoother."""
HARMLESS = 1e-5
"""Distance of plan and run, in natural sizes, up to which chattering does no harm."""


def agrees(plan: OptimalTrajectory, accuracy: float) -> bool:
    """Whether the run comes to where the plan says, and repeats itself with half of its steps."""
    return bool(plan.deviation <= accuracy and plan.step_error <= accuracy)


def exploits_nodes(plan: OptimalTrajectory) -> bool:
    """Whether its controls chatter, and the run under them is elsewhere."""
    return bool(chattering(plan.controls)) and not agrees(plan, HARMLESS)


def judged(plan: OptimalTrajectory, accuracy: float, smoothed: bool) -> OptimalTrajectory:
    """The plan with a status that the verifying run decides, and warnings."""
    warnings = [*plan.warnings]
    if smoothed:
        warnings.append(
            "the control of the first plan chattered, and the run under it missed the plan: a "
            "small penalty on second differences smooths it, which the objective does not contain"
        )
    for name, count in chattering(plan.controls).items():
        warnings.append(
            f"{name} chatters: {count} reversals from node to node; a price on its square, or "
            "da.integral of it in the objective, decides it"
        )
    plan = replace(plan, warnings=warnings)
    if not plan.success or agrees(plan, accuracy):
        return plan
    if plan.motion is None:
        text = plan.status.message
    elif not np.isfinite(plan.deviation):
        text = f"the run under the controls fails: {plan.motion.status}"
    elif plan.deviation > accuracy:
        text = (
            f"the run under the controls is {plan.deviation:.2g} natural sizes away from the plan "
            f"on {plan.intervals} intervals, more than accuracy = {accuracy:g}"
        )
    else:
        text = (
            f"the run under the controls changes by {plan.step_error:.2g} natural sizes with half "
            f"of its steps, more than accuracy = {accuracy:g}"
        )
    cure = "give more intervals or steps, or a larger accuracy where the motion is unstable"
    status = Status(Outcome.NOT_CONVERGED, f"{text}; {cure}", plan.duration, plan.status.residual)
    return replace(plan, status=status)
