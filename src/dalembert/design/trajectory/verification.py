"""A plan run forward under its controls: interval by interval, and as a whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.design.trajectory.defects import largest_defect
from dalembert.design.trajectory.method import TrajectoryMethod
from dalembert.design.trajectory.optimal import OptimalTrajectory
from dalembert.design.trajectory.physics import Physics
from dalembert.errors import AnalysisError
from dalembert.model.scheduled import ScheduledModel
from dalembert.results.motion import Motion


def verified(
    plan: OptimalTrajectory, physics: Physics, method: TrajectoryMethod, from_start: bool
) -> OptimalTrajectory:
    """The plan with the motion that its controls make, and how far they are apart.

    Parameters
    ----------
    from_start : it begins where the model does
    """
    q = np.array(list(plan.x.values()))
    defect = largest_defect(physics, plan.planned.trajectory, plan.controls, q)
    try:
        motion = _forward(plan.planned, method, from_start)
    except AnalysisError as error:  # it cannot begin there; the plan stands all the same
        told = replace(plan.status, message=f"{plan.status.message}; not run forward: {error}")
        return replace(plan, defect=defect, status=told)
    return replace(
        plan,
        motion=motion,
        defect=defect,
        deviation=_deviation(plan.planned, motion),
        step_error=_deviation(motion, _forward(plan.planned, method, from_start, 2)),
    )


def _forward(planned: Motion, method: TrajectoryMethod, from_start: bool, finer: int = 1) -> Motion:
    """The motion that the controls make, from where the plan begins, by steps so much finer."""
    model, s = planned.model, planned.trajectory
    assert isinstance(model, ScheduledModel)
    begun = model if from_start else model.begun_at(s.y[:, 0], s.v[:, 0], planned.parameters)
    run = method.forward(float(planned.time[-1]))
    if finer > 1:
        assert isinstance(run.step, float)
        run = replace(run, step=run.step / finer)
    return run.run(begun, planned.parameters)


def _deviation(planned: Motion, motion: Motion) -> float:
    """Largest distance at an instant of the first; not a number where either ends before."""
    if not (motion.status.success and planned.status.success):
        return float("nan")
    seen = motion.trajectory.y[:, :: (motion.time.size - 1) // (planned.time.size - 1)]
    e, s = planned.model.equations, planned.model.scales
    off = e.manifold.lead(planned.trajectory.y, seen)
    return float(np.max(np.abs(off) / s.displacements[:, None], initial=0.0))
