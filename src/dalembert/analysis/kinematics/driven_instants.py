"""When events happen in a driven mechanism, where every instant stands for itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.events import Occurrence, locate, locate_again
from dalembert.results.motion import Motion
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once


@once
def driven_instant(motion: Motion, occurrence: Occurrence) -> float:
    """Time at which an event happens [s], looked for between the positions of the run.

    Raises
    ------
    AnalysisError
        The event is given by a name, or did not happen so often.
    """
    event = occurrence.declared({})
    measure = motion.model.expression(event.measure)

    def value(time: float) -> float:
        return float(motion.at(np.array([time])).values(measure)[0])

    def rate(time: float) -> float:
        return measure_rate(motion.at(np.array([time])), measure)

    if motion.record.origin is not None:
        before = driven_instant(motion.record.origin, occurrence)
        span = float(np.ptp(motion.record.path.t))
        return locate_again(value, rate, before, str(occurrence), span)
    path = replace(motion, trajectory=motion.record.path)
    k = occurrence.among(event.crossings(path.values(measure)).tolist())
    return locate(value, float(path.time[k]), float(path.time[k + 1]))


def measure_rate(motion: Motion, measure: Expression, k: int = -1) -> float:
    """``ṁ`` at the ``k``-th instant, the total derivative along the driven motion."""
    s, p = motion.trajectory, motion.parameters
    y = motion.record.kernel.near(s)[:, k]
    tangent = motion.record.kernel.measured(measure).tangent
    return float(tangent(s.t[k], y, p, 1.0, np.zeros(y.size), np.zeros(p.size)))
