"""Dense outputs of a motion, and quadrature of exponentials of measures over them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.dynamics.dense_outputs import DenseOutputs, contact_changes, jumps_between
from dalembert.analysis.dynamics.instants import end_by_event
from dalembert.analysis.dynamics.step_quadrature import StepQuadrature
from dalembert.analysis.kinematics.branches import Branches, outputs_of, place_outputs
from dalembert.results.motion import Motion
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once

NEGLIGIBLE = 40.0
"""Difference of exponents from which on the smaller exponential is negligible."""
RISE = 0.5
"""Upper limit of the change of an exponent within a part of a step."""
STEP_PARTS, PARTS = 512, 50_000
"""Upper limits of the number of parts of a step, and of all steps."""


@once
def dense(motion: Motion) -> Motion:
    """The motion at dense outputs, from its first output to its last."""
    record, time = motion.record, motion.time
    if record.dense or not record.steps.count or time.size < 2:
        return motion
    kernel, steps, p = record.kernel, record.steps, motion.parameters
    jumps = contact_changes(kernel, steps)
    times, branches = outputs_of(steps, None, end_by_event(motion) is not None, jumps)
    inside = (times > time[0] + steps.instant) & (times < time[-1] - steps.instant)
    ends = place_outputs(steps, time[[0, -1]])
    index, length = (
        np.concatenate([ends_of_motion[:1], values[inside], ends_of_motion[1:]])
        for ends_of_motion, values in ((ends.index, branches.index), (ends.length, branches.length))
    )
    times = np.concatenate([time[:1], times[inside], time[-1:]])
    outputs = DenseOutputs(kernel, steps, times, Branches(index, length), p)
    record_at_outputs = replace(record, branches=outputs.branches, dense=True)
    return replace(motion, trajectory=outputs.trajectory, record=record_at_outputs)


def peak_quadrature(
    motion: Motion, measure: str | Expression, sharpness: float, sign: float, order: int
) -> StepQuadrature | None:
    """Quadrature points that resolve ``exp(± sharpness m)`` as well as the motion.

    None where the run has fixed steps, or outputs over a part of it only.
    """
    record, time = motion.record, motion.time
    steps = record.steps
    if record.kernel.adaptive is None or not steps.count or time.size < 2:
        return None
    if time[0] > steps.t[0] + steps.instant or time[-1] < steps.end - steps.instant:
        return None
    dense_motion = dense(motion)
    m = sign * sharpness * dense_motion.values(measure)
    if not np.all(np.isfinite(m)):
        return None
    intervals, index = np.diff(dense_motion.time), dense_motion.record.branches.index
    lasting, index = ~jumps_between(steps, dense_motion.time, index), index[:-1]
    slope = np.abs(np.diff(m)) / np.where(lasting, intervals, 1.0)
    bend = np.sqrt(np.abs(np.diff(slope, append=slope[-1:])) / np.where(lasting, intervals, 1.0))
    steep = np.where(lasting, np.maximum(slope, bend), 0.0)
    steep[np.maximum(m[1:], m[:-1]) < m.max() - NEGLIGIBLE] = 0.0
    steepest = np.zeros(steps.count)
    np.maximum.at(steepest, index, steep)
    parts = np.clip(np.ceil(steepest * steps.h / RISE), 1, STEP_PARTS).astype(int)
    return StepQuadrature(steps, order, parts) if parts.sum() <= PARTS else None
