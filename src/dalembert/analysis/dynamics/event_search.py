"""Search for events among the steps of a dynamic run, and their instants when it is repeated.

A repeated run takes the same steps with other parameters. Its events are located again, each in its
original step: the branch of the motion stays the same, so the instant is a smooth function of the
parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.flow import Flow
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_outputs import cubic
from dalembert.analysis.dynamics.variant import Variant
from dalembert.analysis.events import Event, Occurrence, as_events, locate, locate_again
from dalembert.analysis.output_places import OutputPlaces
from dalembert.integrators.marching.checkpoints import States
from dalembert.integrators.marching.steps import Steps
from dalembert.results.motion import Motion
from dalembert.results.recording import EventRecord
from dalembert.results.result import Result
from dalembert.results.status import Outcome
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once

SHORTEST = 1e-12
"""Length, relative to the step, of a step that is cut at its beginning."""
PARTS = np.arange(1, 16) / 16
"""Fractions of a step at which the cubic through its ends is evaluated."""
NEAR = 0.5
"""Value of the cubic, relative to the smaller one at the ends, below which a step is examined."""
Crossed = tuple[int, float, float]
"""Number of a step, and begin and end of the part with one zero crossing [s]."""


class EventSearch:
    """Search for zero crossings of measures, accelerations and multipliers included.

    Parameters
    ----------
    kernel : DynamicsKernel of the run
    events : name → Event
    p : (np,) parameters
    """

    def __init__(self, kernel: DynamicsKernel, events: Mapping[str, Event], p: np.ndarray):
        self.kernel, self.events, self.p = kernel, events, p

    @cached_property
    def measures(self) -> dict[str, Expression]:
        model = self.kernel.model
        return {name: model.expression(event.measure) for name, event in self.events.items()}

    def values(self, name: str, times: np.ndarray, states: States, modes: np.ndarray) -> np.ndarray:
        """Values of an event's measure."""
        measure = self.measures[name]
        values = self.kernel.mapped(
            lambda variant: variant.measured(measure).function,
            modes,
            times,
            states,
            self.p,
        )
        return values[0].ravel()

    def terminal_crossing(self, times: np.ndarray, states: np.ndarray, modes: np.ndarray) -> bool:
        """Whether a terminal event happens between these states, with the modes of the steps."""
        corrected = np.ones(modes.size, dtype=bool)
        steps = Steps(times[:-1], np.diff(times), states, corrected, modes)
        return any(self.crossings(n, steps) for n, event in self.events.items() if event.terminal)

    def crossings(self, name: str, steps: Steps) -> list[Crossed]:
        """Parts of steps in which an event happens, in temporal order."""
        if not steps.count:
            return []
        times = np.append(steps.t[: steps.count], steps.end)
        values = self.values(name, times, steps.x, np.append(steps.mode, steps.mode[-1:]))
        parts = [(int(k), 0.0, float(steps.h[k])) for k in self.events[name].crossings(values)]
        if self.kernel.adaptive is not None:
            parts += self._double_crossings(name, steps, times, values)
        return sorted(parts)

    def _double_crossings(
        self, name: str, steps: Steps, times: np.ndarray, values: np.ndarray
    ) -> list[Crossed]:
        """Crossings within a step at both ends of which the measure has the same sign.

        Steps are examined where the cubic through values and rates at their ends comes near zero.
        """
        event, measure, h = self.events[name], self.measures[name], steps.h

        def rates(modes: np.ndarray) -> np.ndarray:
            function = partial(measured_rate, measure=measure)
            return self.kernel.mapped(function, modes, times, steps.x, self.p)[0].ravel()

        same_sign = (h > 0) & (values[:-1] * values[1:] > 0)
        if not same_sign.any():
            return []
        sign, modes = np.sign(values[:-1]), steps.mode
        begin, end = rates(np.append(modes, modes[-1]))[:-1], rates(np.append(modes[0], modes))[1:]
        inside = cubic(PARTS[:, None], values[:-1], values[1:], h * begin, h * end)
        nearest = (sign * inside).min(axis=0)
        near = same_sign & (nearest < NEAR * np.minimum(abs(values[:-1]), abs(values[1:])))
        flow, crossings = Flow(self.kernel, steps, self.p), list[Crossed]()
        for k in map(int, np.flatnonzero(near)):
            part = negative_point(lambda s, k=k: sign[k] * flow.value(measure, k, s), float(h[k]))  # type: ignore[misc]
            if part is None:
                continue
            crossings += [(k, 0.0, part)] if event.passes(-sign[k]) else []
            crossings += [(k, part, float(h[k]))] if event.passes(sign[k]) else []
        return crossings

    def locate(self, name: str, steps: Steps, crossed: Crossed) -> float:
        """Time from the beginning of a step to the crossing inside it [s]."""
        flow, measure = Flow(self.kernel, steps, self.p), self.measures[name]
        k, begin, end = crossed
        return locate(lambda length: flow.value(measure, k, length), begin, end)

    def find(self, steps: Steps) -> tuple[list[EventRecord], tuple[int, float] | None]:
        """Events up to the first terminal one; step and length of the terminal one, if any."""
        crossings: list[tuple[float, str, float, Crossed]] = []
        for name in self.events:
            for crossed in self.crossings(name, steps):
                length = self.locate(name, steps, crossed)
                crossings.append((float(steps.t[crossed[0]] + length), name, length, crossed))
        crossings.sort()
        for i, (_, name, length, crossed) in enumerate(crossings):
            if self.events[name].terminal:
                records = [self._record(*event, steps) for event in crossings[: i + 1]]
                return records, (crossed[0], length)
        return [self._record(*event, steps) for event in crossings], None

    def _record(
        self, time: float, name: str, length: float, crossed: Crossed, steps: Steps
    ) -> EventRecord:
        flow, (k, begin, _) = Flow(self.kernel, steps, self.p), crossed
        y, v = flow.bodies(k, length)
        before = flow.value(self.measures[name], k, begin)
        return EventRecord(name, time, -int(np.sign(before)), y, v)

    def cut(self, steps: Steps, k: int, length: float) -> Steps:
        """The steps up to the ``k``-th, which is shortened to ``length``."""
        return Flow(self.kernel, steps, self.p).shortened(
            k, max(length, SHORTEST * float(steps.h[k]))
        )


@once
def measured_rate(variant: Variant, measure: Expression) -> ca.Function:
    """``(t, x, p) → ṁ`` along the motion."""
    rate = variant.rate.function
    t, x, p = (ca.MX.sym(name, rate.numel_in(i)) for i, name in enumerate("txp"))
    value = variant.measured(measure).tangent(t, x, p, 1, rate(t, x, p), ca.MX(p.numel(), 1))
    return ca.Function("measured_rate", [t, x, p], [ca.densify(value)])


def negative_point(value: Callable[[float], float], length: float) -> float | None:
    """Length in a step at which a value, positive at both ends, is negative; None if nowhere."""
    from scipy.optimize import minimize_scalar

    minimum = minimize_scalar(value, bounds=(0.0, length), method="bounded")
    return float(minimum.x) if minimum.fun < 0 else None


@dataclass(frozen=True)
class Instant:
    """``length`` seconds after the beginning of step ``index``."""

    index: int
    length: float

    @property
    def places(self) -> OutputPlaces:
        return OutputPlaces(np.array([self.index]), np.array([self.length]))


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
