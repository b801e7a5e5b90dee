"""Instants of events of a dynamic run, also when the run is repeated.

A repeated run takes the same steps with other parameters. Its events are located again, each in its
original step: the branch of the motion stays the same, so the instant is a smooth function of the
parameters.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.analysis.dynamics.event_search import EventSearch
from dalembert.analysis.dynamics.flow import Flow
from dalembert.analysis.events import Event, Occurrence, as_events, locate_again
from dalembert.analysis.kinematics.branches import Branches
from dalembert.integrators.marching.steps import Steps
from dalembert.results.motion import Motion
from dalembert.results.result import Result
from dalembert.results.status import Outcome
from dalembert.symbolic.once import once


@dataclass(frozen=True)
class Instant:
    """``length`` seconds after the beginning of step ``index``."""

    index: int
    length: float

    @property
    def branches(self) -> Branches:
        return Branches(np.array([self.index]), np.array([self.length]))


def end_by_event(motion: Result) -> Occurrence | None:
    """The terminal event at the last output, if the run ended by one."""
    if motion.status.outcome is not Outcome.TERMINATED:
        return None
    if not motion.time.size or motion.time[-1] != motion.record.steps.end:
        return None
    name = motion.events[-1].name
    return Occurrence(name, sum(record.name == name for record in motion.events))


@once
def instant_of(motion: Motion, occurrence: Occurrence) -> Instant:
    """Step and length at which an event happened.

    Raises
    ------
    AnalysisError
        Unknown event, or fewer occurrences.
    """
    event = occurrence.declared(as_events(motion.analysis.events))
    origin, steps = motion.record.origin, motion.record.steps
    if origin is not None:
        flow = Flow(motion.record.kernel, steps, motion.parameters)
        return _moved(motion, flow, event, instant_of(origin, occurrence))
    name = occurrence.event if isinstance(occurrence.event, str) else _name_of(motion, event)
    if name is None:
        search = EventSearch(motion.record.kernel, {"": event}, motion.parameters)
        crossed = occurrence.among(search.crossings("", steps))
        return _placed(steps, float(steps.t[crossed[0]]) + search.locate("", steps, crossed))
    time = occurrence.among([record.time for record in motion.events if record.name == name])
    ends = motion.status.outcome is Outcome.TERMINATED and time == motion.events[-1].time
    return _end(steps) if ends and name == motion.events[-1].name else _placed(steps, time)


def ended_again(motion: Motion, steps: Steps, p: np.ndarray) -> Steps:
    """Repeated steps of a run, cut at the new instant of its terminal event.

    Raises
    ------
    AnalysisError
        The event does not happen any more.
    """
    name = motion.events[-1].name
    event = as_events(motion.analysis.events)[name]
    flow = Flow(motion.record.kernel, steps, p)
    instant = _moved(motion, flow, event, _end(motion.record.steps))
    return flow.shortened(instant.index, instant.length)


def _moved(motion: Motion, flow: Flow, event: Event, original: Instant) -> Instant:
    """Instant of an event in the flow at other parameters, near the original one."""
    measure, k = motion.model.expression(event.measure), original.index
    length = locate_again(
        lambda s: flow.value(measure, k, s),
        lambda s: flow.rate(measure, k, s),
        original.length,
        str(Occurrence(event)),
        flow.steps.end - float(flow.steps.t[0]),
    )
    return Instant(k, length)


def _name_of(motion: Motion, event: Event) -> str | None:
    events = as_events(motion.analysis.events)
    return next((name for name, other in events.items() if other == event), None)


def _end(steps: Steps) -> Instant:
    return Instant(steps.count - 1, float(steps.h[-1]))


def _placed(steps: Steps, time: float) -> Instant:
    """Step and length of a time; a common end of two steps belongs to the first one."""
    k = int(np.clip(np.searchsorted(steps.t[: steps.count], time) - 1, 0, steps.count - 1))
    length, tolerance = time - float(steps.t[k]), steps.instant
    if length < tolerance and k > 0:
        return Instant(k - 1, float(steps.h[k - 1]))
    end = float(steps.h[k])
    return Instant(k, end if abs(length - end) < tolerance else length)
