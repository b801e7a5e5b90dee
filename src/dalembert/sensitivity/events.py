"""Gradients of responses at events, whose instants depend on the parameters.

At an event ``g(t*, x, p) = 0`` the instant moves by ``dt*/dp = −(dg/dp)/ġ``, and a response with
its last sample there by

    dR/dp = Σ w_k dm_k/dp + (Σ w_k s_k ṁ_k + ∂R/∂t_K) dt*/dp,

where ``s_k`` is 1 for the last sample, 0 for others except those inside a last step that grows, and
``d/dp`` is taken at fixed times and the dot along the motion (Bestle and Eberhard 1992). So it is
the gradient of the response minus a multiple of that of ``g``, both computed by any engine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from dalembert.analysis.dynamics.event_search import end_by_event
from dalembert.analysis.events import Event, Occurrence, as_events
from dalembert.analysis.timeline import checked_span
from dalembert.errors import SingularityError
from dalembert.responses.events import AtEvent
from dalembert.results.result import Result
from dalembert.sensitivity.engine import Engine
from dalembert.sensitivity.samples import Sample, take_sample

GRAZING = 1e-7
"""Threshold of the rate of an event measure, relative to its size over elapsed time [-]."""
SIMULTANEOUS = 1e-10
"""Threshold of the distance of two events, relative to the elapsed time [-]."""
SIZE_SAMPLES = 33
"""Number of instants at which an event measure is evaluated for its size."""


@dataclass
class Gate:
    """Event of a run at which responses are evaluated.

    Parameters
    ----------
    motion : the run
    occurrence : the event and its number
    engine : engine of the run, for rates
    """

    motion: Result
    occurrence: Occurrence
    engine: Engine

    @cached_property
    def sample(self) -> Sample:
        """The measure of the event at its instant."""
        return self._sample_of(self.event)

    @cached_property
    def event(self) -> Event:
        return self.occurrence.declared(self._declared)

    @property
    def time(self) -> float:
        return float(self.sample.motion.time[-1])

    @cached_property
    def rate(self) -> float:
        """``ġ`` at the event.

        Raises
        ------
        SingularityError
            The rate is zero: the event grazes.
        """
        rate = self.engine.rate(self.sample)
        if not abs(rate) * self._elapsed > GRAZING * self._size:
            raise SingularityError(
                f"event {str(self.occurrence)!r} at t = {self.time:.9g} s grazes: its measure "
                f"changes at {rate:.3g} per second, so its instant has no derivative; move the "
                "event or the parameters"
            )
        return rate

    def refuse_simultaneous(self) -> None:
        """Raise if another event ends the run at the same instant.

        Raises
        ------
        SingularityError
            Names both.
        """
        end = end_by_event(self.motion)
        if end is None or abs(self.time - self.motion.time[-1]) > SIMULTANEOUS * self._elapsed:
            return
        for name, other in self._declared.items():
            if not other.terminal or other in (self.event, self.occurrence.event):
                continue
            sample = self._sample_of(other)
            rate = self.engine.rate(sample)
            if abs(sample.value) <= SIMULTANEOUS * self._elapsed * abs(rate) and other.passes(rate):
                raise SingularityError(
                    f"events {str(self.occurrence)!r} and {name!r} happen in the same instant "
                    f"t = {self.time:.9g} s and {name!r} ends the run: which is first depends on "
                    "the parameters, so there is no derivative; move one of them"
                )

    def _sample_of(self, event: Event) -> Sample:
        measure, own = self.motion.model.expression(event.measure), self.occurrence
        return take_sample(self.motion, AtEvent(measure, event=own.event, occurrence=own.number))

    @property
    def _declared(self) -> dict[str, Event]:
        return as_events(self.motion.analysis.events)

    @cached_property
    def _start(self) -> float:
        analysis: Any = self.motion.analysis  # an analysis over time with events
        return checked_span(analysis.duration, analysis.t_span)[0]

    @property
    def _elapsed(self) -> float:
        return self.time - self._start

    @property
    def _size(self) -> float:
        """Largest value of the event measure up to the event."""
        samples = self.motion.at(np.linspace(self._start, self.time, SIZE_SAMPLES))
        return float(np.abs(samples.values(self.sample.measure)).max())


class EventEngine(Engine):
    """Gradients at fixed times by another engine, plus the terms of moving instants.

    Parameters
    ----------
    motion : the run
    kind : class of the engine of the analysis
    samples : responses of the run, some of which end at events

    Raises
    ------
    SingularityError
        An event whose instant has no derivative.
    """

    def __init__(self, motion: Result, kind: type[Engine], samples: Sequence[Sample]):
        super().__init__(samples)
        engine = kind(samples)
        gates: dict[Occurrence, Gate] = {}
        shares: list[tuple[int, int, float]] = []
        for i, sample in enumerate(samples):
            event, weights = sample.final_event, sample.weights * sample.time_derivatives
            moving = np.flatnonzero(weights)
            if event is None or not (moving.size or sample.time_weights[-1]):
                continue
            gate = gates.setdefault(event, Gate(motion, event, engine))
            gate.refuse_simultaneous()
            by_time = sample.time_weights[-1] + sum(
                weights[k] * engine.rate(sample, int(k)) for k in moving
            )
            shares.append((i, list(gates).index(event), -by_time / gate.rate))
        self.fixed = kind([*samples, *(gate.sample for gate in gates.values())])
        self.mix = np.eye(len(self.samples), len(self.fixed.samples))
        for i, j, share in shares:
            self.mix[i, len(self.samples) + j] = share

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        return self.mix @ self.fixed.direct(columns)

    def adjoint(self) -> np.ndarray:
        return self.mix @ self.fixed.adjoint()
