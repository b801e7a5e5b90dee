"""Continuation of a run beyond its end.

The continued run starts with the state, signs of the switching functions, contact phases and
integrator memory with which the earlier run ended. The steps of both form one march from the first
start, so outputs, events, energy, integrals, replays and gradients cover the whole.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.dynamics.run import DynamicsRun
from dalembert.analysis.timeline import OverTime, checked_span, checked_step, output_times
from dalembert.analysis.times import follow_parameters, in_seconds
from dalembert.errors import AnalysisError
from dalembert.integrators.marching.steps import Steps, Watch
from dalembert.results.motion import Motion
from dalembert.results.status import Outcome

EQUAL_SPACING = 1e-9
"""Relative difference below which distances between outputs are equal."""

A = TypeVar("A", bound=OverTime[Any])
CONTINUABLE = Outcome.COMPLETED, Outcome.TERMINATED, Outcome.INTERRUPTED
"""Outcomes of runs that can be continued."""
CONTACT_STATISTICS = "simultaneous impacts", "accumulation of impacts"
"""Statistics of contacts that are joined over both runs."""
END_TOLERANCE = 1e-9
"""Fraction of the continuation in which the event that ended the earlier run is located again."""


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
            "times of this run follow parameters; compute a longer run instead of continuing it"
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
            raise AnalysisError(
                "the outputs of this run are not equally spaced; give outputs= for the continuation"
            )
        requested = 1 + max(1, round((end - begin) / spacing))
    times = output_times(requested, begin, end)
    assert times is not None
    later = times[times > motion.time[-1:].max(initial=begin)]
    return (*motion.time.tolist(), *later.tolist())


def refuse_ended(motion: Motion, before: float) -> None:
    """Refuse to continue a run that an event ended up to a time.

    Raises
    ------
    AnalysisError
        Names the event.
    """
    if motion.status.outcome is Outcome.TERMINATED and motion.status.time <= before:
        raise AnalysisError(
            f"this run was ended by event {motion.events[-1].name!r} at "
            f"t = {motion.status.time:.9g} s; continue it with other events=, or events={{}} for "
            "none"
        )


class ContinuedRun(DynamicsRun):
    """A run that continues another from its end.

    Parameters
    ----------
    motion : the earlier run
    analysis : analysis of the whole, from the first start to the new end
    step : length of the following steps [s]

    Raises
    ------
    AnalysisError
        The earlier run failed.
    """

    def __init__(self, motion: Motion, analysis: Any, step: float):
        if motion.status.outcome not in CONTINUABLE or not motion.record.steps.count:
            raise AnalysisError(f"this run cannot be continued, it ended {motion.status}")
        super().__init__(analysis, motion.model, motion.parameters)
        self.before, self.step = motion, step
        self.past: Steps = motion.record.steps
        self.begin = self.past.end
        if self.contacts is not None:
            self.contacts.impacts = list(motion.impacts)

    def initial_state(self) -> tuple[np.ndarray, int]:
        """Final state of the earlier run, and the variant of the following steps."""
        super().initial_state()  # for its warnings
        if self.contacts is not None:
            self.contacts.trouble = ""
        return np.asarray(self.past.x[:, self.past.count]), self._following()

    def _following(self) -> int:
        variants, mode = self.kernel.variants, int(self.past.mode[-1])
        last = variants[mode]
        if isinstance(last, ContactChange):
            return variants.index(last.after)
        before = getattr(last, "variant", None)  # of a transition or sample
        return mode if before is None else variants.index(before)

    @property
    def first_step(self) -> float:
        """The longer one of the last two steps; the last one was cut at the end [s]."""
        return float(self.past.h[self.past.lasting[-2:]].max())

    @property
    def instants(self) -> np.ndarray:
        return np.append(self.before.time, self.grid[1:])

    def march(self, x0: np.ndarray, mode: int, watch: Watch) -> Steps:
        return self.kernel.fixed.joined(self.past, super().march(x0, mode, watch), self.p)

    def execute(self, progress: Any) -> Motion:
        motion = super().execute(progress)
        refuse_ended(motion, before=self.begin + END_TOLERANCE * (self.end - self.begin))
        for name in CONTACT_STATISTICS:
            texts = [m.statistics[name] for m in (self.before, motion) if name in m.statistics]
            if texts:
                motion.statistics[name] = ", ".join(texts)
        return motion
