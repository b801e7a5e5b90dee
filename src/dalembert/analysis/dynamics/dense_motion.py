"""A motion at dense outputs from its first to its last one, and quadratures of powers over it."""

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
"""Distance of exponents below which the smaller power counts for nothing."""
RISE = 0.5
"""Change of an exponent within a part of a step."""
STEP_PARTS, PARTS = 512, 50_000
"""Upper limits of the parts of a step, and of all steps."""


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
        np.concatenate([at[:1], some[inside], at[1:]])
        for at, some in ((ends.index, branches.index), (ends.length, branches.length))
    )
    times = np.concatenate([time[:1], times[inside], time[-1:]])
    found = DenseOutputs(kernel, steps, times, Branches(index, length), p)
    made = replace(record, branches=found.branches, dense=True)
    return replace(motion, trajectory=found.trajectory, record=made)


def peak_quadrature(
    motion: Motion, measure: str | Expression, sharpness: float, sign: float, order: int
) -> StepQuadrature | None:
    """Points over the run at which ``exp(± sharpness m)`` is as smooth as the motion.

    None where the run has fixed steps, or outputs over a part of it only.
    """
    record, time = motion.record, motion.time
    steps = record.steps
    if record.kernel.adaptive is None or not steps.count or time.size < 2:
        return None
    if time[0] > steps.t[0] + steps.instant or time[-1] < steps.end - steps.instant:
        return None
    finely = dense(motion)
    m = sign * sharpness * finely.values(measure)
    if not np.all(np.isfinite(m)):
        return None
    apart, index = np.diff(finely.time), finely.record.branches.index
    lasting, index = ~jumps_between(steps, finely.time, index), index[:-1]
    slope = np.abs(np.diff(m)) / np.where(lasting, apart, 1.0)
    bend = np.sqrt(np.abs(np.diff(slope, append=slope[-1:])) / np.where(lasting, apart, 1.0))
    steep = np.where(lasting, np.maximum(slope, bend), 0.0)
    steep[np.maximum(m[1:], m[:-1]) < m.max() - NEGLIGIBLE] = 0.0
    most = np.zeros(steps.count)
    np.maximum.at(most, index, steep)
    parts = np.clip(np.ceil(most * steps.h / RISE), 1, STEP_PARTS).astype(int)
    return StepQuadrature(steps, order, parts) if parts.sum() <= PARTS else None
