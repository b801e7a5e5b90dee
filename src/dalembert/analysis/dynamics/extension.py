"""The analysis of a continued run: its options over the longer span."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np

from dalembert.analysis.over_time import OverTime
from dalembert.analysis.timeline import checked_span, checked_step, output_times
from dalembert.analysis.times import follow_parameters, in_seconds
from dalembert.errors import AnalysisError
from dalembert.results.motion import Motion

EQUAL_SPACING = 1e-9
"""Relative difference below which distances between outputs are equal."""

A = TypeVar("A", bound=OverTime[Any])


def extended(
    analysis: A, motion: Motion, duration: Any, options: Mapping[str, Any]
) -> tuple[A, float]:
    """The analysis from the start of a motion to a later end, and the step of the continuation.

    Parameters
    ----------
    duration : of the continuation [s]
    options : step, outputs of the continuation and events, if they differ from the earlier run

    Raises
    ------
    AnalysisError
        Times that follow parameters, or that are inconsistent.
    """
    if follow_parameters(analysis):
        raise AnalysisError(
            "times of this run follow parameters; ask for a longer one instead of continuing it"
        )
    arguments = in_seconds(
        {"duration": duration, **options}, motion.model, motion.parameters, "continued"
    )
    start, end = checked_span(analysis.duration, analysis.t_span)
    begin = motion.record.steps.end
    _, length = checked_span(float(arguments.pop("duration")), None)
    default_step = checked_step(analysis.step, start, end)
    step = float(arguments.pop("step", default_step))
    checked_step(step, begin, begin + length)
    requested = arguments.pop("outputs", None)
    outputs = _outputs(analysis, motion, requested, begin, begin + length)
    changes: dict[str, Any] = {"duration": None, "t_span": (start, begin + length)}
    changes |= {"outputs": outputs, **arguments}
    if "step" in options or (analysis.step is None and motion.record.kernel.adaptive is None):
        changes["step"] = step
    if "integrator" in {f.name for f in fields(analysis)}:  # a step does not select another one
        changes["integrator"] = copy(analysis.integrator)  # type: ignore[attr-defined]
    return replace(analysis, **changes), step


def _outputs(
    analysis: OverTime[Any], motion: Motion, requested: Any, begin: float, end: float
) -> tuple[float, ...] | None:
    """Output times of the whole: of the earlier run, then the requested or equally spaced ones."""
    if requested is None and analysis.outputs is None:
        return None
    if requested is None:
        spacing, intervals = end - begin, np.diff(motion.time)
        if intervals.size:
            spacing = float(intervals[0])
        if (
            np.sum(np.abs(intervals - spacing) > EQUAL_SPACING * spacing) > 1
        ):  # the last may be an event
            raise AnalysisError("this run had times of its own; give outputs= for what follows")
        requested = 1 + max(1, round((end - begin) / spacing))
    times = output_times(requested, begin, end)
    assert times is not None
    later = times[times > motion.time[-1:].max(initial=begin)]
    return (*motion.time.tolist(), *later.tolist())
