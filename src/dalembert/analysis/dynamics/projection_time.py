"""What projections cost in a run: they are part of the function of a step, so measured anew."""

from __future__ import annotations

from time import perf_counter
from typing import Any

import numpy as np

from dalembert.analysis.dynamics.record import DynamicsRecord

MOST = 200
"""States at which it is measured."""
MACHINE = "VM"
"""Backend that evaluates functions one by one as it does inside a step."""


def projection_time(motion: Any) -> float | None:
    """Seconds that the projections of a run took, None where there are none or it was compiled."""
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
