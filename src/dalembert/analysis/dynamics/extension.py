"""The analysis of a run that goes on: its options over the longer span."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np

from dalembert.analysis.timeline import OverTime, checked_span, checked_step, output_times
from dalembert.analysis.times import follow_parameters, in_seconds
from dalembert.errors import AnalysisError
from dalembert.results.motion import Motion

EVEN = 1e-9
"""Difference, relative, of distances between outputs that count as equal."""

A = TypeVar("A", bound=OverTime[Any])


def extended(
    analysis: A, motion: Motion, duration: Any, options: Mapping[str, Any]
) -> tuple[A, float]:
    """The analysis from the start of a motion to a later end, and the step of what follows.

    Parameters
    ----------
    duration : of what follows [s]
    options : step, outputs of what follows and events, where they are others than before

    Raises
    ------
    AnalysisError
        Times that follow parameters, or that do not fit each other.
    """
    if follow_parameters(analysis):
        raise AnalysisError(
            "times of this run follow parameters; ask for a longer one instead of continuing it"
        )
    given = in_seconds(
        {"duration": duration, **options}, motion.model, motion.parameters, "continued"
    )
    start, end = checked_span(analysis.duration, analysis.t_span)
    begin = motion.record.steps.end
    _, length = checked_span(float(given.pop("duration")), None)
    usual = checked_step(analysis.step, start, end)
    step = float(given.pop("step", usual))
    checked_step(step, begin, begin + length)
    asked = given.pop("outputs", None)
    outputs = _outputs(analysis, motion, asked, begin, begin + length)
    whole: dict[str, Any] = {"duration": None, "t_span": (start, begin + length)}
    whole |= {"outputs": outputs, **given}
    if "step" in options or (analysis.step is None and motion.record.kernel.adaptive is None):
        whole["step"] = step
    if "integrator" in {f.name for f in fields(analysis)}:  # a step selects no other one here
        whole["integrator"] = copy(analysis.integrator)  # type: ignore[attr-defined]
    return replace(analysis, **whole), step


def _outputs(
    analysis: OverTime[Any], motion: Motion, asked: Any, begin: float, end: float
) -> tuple[float, ...] | None:
    """Those of the whole: of the run before, and after it those asked for or as far apart."""
    if asked is None and analysis.outputs is None:
        return None
    if asked is None:
        apart, between = end - begin, np.diff(motion.time)
        if between.size:
            apart = float(between[0])
        if np.sum(np.abs(between - apart) > EVEN * apart) > 1:  # the last may be an event
            raise AnalysisError("this run had times of its own; give outputs= for what follows")
        asked = 1 + max(1, round((end - begin) / apart))
    times = output_times(asked, begin, end)
    assert times is not None
    later = times[times > motion.time[-1:].max(initial=begin)]
    return (*motion.time.tolist(), *later.tolist())
