"""Computation time of projections inside compiled steps, by repeated evaluation."""

from __future__ import annotations

from time import perf_counter
from typing import Any

import numpy as np

from dalembert.analysis.dynamics.record import DynamicsRecord

MOST = 200
"""Upper limit of the number of states at which the time is measured."""
MACHINE = "VM"
"""Backend whose evaluation time is the same inside and outside of a step."""


def projection_time(motion: Any) -> float | None:
    """Computation time of the projections of a run [s]; None without projections or if compiled."""
    record, statistics = motion.record, motion.statistics
    count = statistics.get("projections", 0)
    if not isinstance(record, DynamicsRecord) or not count or statistics["backend"] != MACHINE:
        return None
    steps = record.steps
    last = int(steps.lasting[-1])
    correction = record.kernel.variants[int(steps.mode[last])].problem.correction
    if correction is None:
        return None
    columns = min(MOST, steps.count)
    states = np.asarray(steps.x[:, steps.count - columns : steps.count])
    times = steps.t[steps.count - columns : steps.count]
    parameters = np.tile(motion.parameters[:, None], columns)
    function = correction.function.map(columns)
    function(times, states, parameters)
    begin = perf_counter()
    function(times, states, parameters)
    return (perf_counter() - begin) * count / columns
