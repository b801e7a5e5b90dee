"""Gradients of responses that look at events, whose instants depend on the parameters.

At an event ``g(t*, x, p) = 0`` the instant moves by ``dt*/dp = −(dg/dp)/ġ``, and a response with
its last sample there by

    dR/dp = Σ w_k dm_k/dp + (Σ w_k s_k ṁ_k + ∂R/∂t_K) dt*/dp,

where ``s_k`` is one for the last sample, zero for others but those inside a last step that grows,
and ``d/dp`` is taken at fixed times and the dot along the motion (Bestle and Eberhard 1992). So
it is the gradient of the response minus a multiple of that of ``g``, both of any engine.
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
"""Rate of an event's measure, relative to its largest value over the time passed, that is none."""
TOGETHER = 1e-10
"""Distance of two events, relative to the time passed, that is none."""
LOOKS = 33
"""Instants at which an event's measure is looked at for its size."""


@dataclass
class Gate:
    """An event at which a run is looked at.

    Parameters
    ----------
    motion : the run
    occurrence : which event
    engine : of the run, to ask for rates
    """

    motion: Result
    occurrence: Occurrence
    engine: Engine

    @cached_property
    def sample(self) -> Sample:
        """The event's measure at its instant."""
        return self._seen(self.event)

    @cached_property
    def event(self) -> Event:
        return self.occurrence.declared(self._declared)

    @property
    def time(self) -> float:
        return float(self.sample.motion.time[-1])

    @cached_property
    def rate(self) -> float:
        """``ġ`` there.

        Raises
        ------
        SingularityError
            It is zero: the event is only just reached.
        """
        rate = self.engine.rate(self.sample)
        if not abs(rate) * self._passed > GRAZING * self._size:
            raise SingularityError(
                f"event {str(self.occurrence)!r} at t = {self.time:.9g} s grazes: its measure "
                f"changes at {rate:.3g} per second, so its instant has no derivative; move the "
                "event or the parameters"
            )
        return rate

    def refuse_company(self) -> None:
        """Another event that ends the run in the same instant decides with this one.

        Raises
        ------
        SingularityError
            Names both.
        """
        end = end_by_event(self.motion)
        if end is None or abs(self.time - self.motion.time[-1]) > TOGETHER * self._passed:
            return
        for name, other in self._declared.items():
            if not other.terminal or other in (self.event, self.occurrence.event):
                continue
            seen = self._seen(other)
            rate = self.engine.rate(seen)
            if abs(seen.value) <= TOGETHER * self._passed * abs(rate) and other.passes(rate):
                raise SingularityError(
                    f"events {str(self.occurrence)!r} and {name!r} happen in the same instant "
                    f"t = {self.time:.9g} s and {name!r} ends the run: which is first depends on "
                    "the parameters, so there is no derivative; move one of them"
                )

    def _seen(self, event: Event) -> Sample:
        measure, (which, n) = self.motion.model.expression(event.measure), self._which
        return take_sample(self.motion, AtEvent(measure, event=which, occurrence=n))

    @property
    def _which(self) -> tuple[str | Event, int]:
        return self.occurrence.event, self.occurrence.number

    @property
    def _declared(self) -> dict[str, Event]:
        return as_events(self.motion.analysis.events)

    @cached_property
    def _start(self) -> float:
        analysis: Any = self.motion.analysis  # one over time: it has events
        return checked_span(analysis.duration, analysis.t_span)[0]

    @property
    def _passed(self) -> float:
        return self.time - self._start

    @property
    def _size(self) -> float:
        """Largest value of the event's measure until it happens."""
        looks = self.motion.at(np.linspace(self._start, self.time, LOOKS))
        return float(np.abs(looks.values(self.sample.measure)).max())


class EventEngine(Engine):
    """Gradients at fixed times by another engine, and what moving instants add to them.

    Parameters
    ----------
    motion : the run
    kind : engine of the analysis
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
            which, seen = sample.moves_with, sample.weights * sample.shares
            moving = np.flatnonzero(seen)
            if which is None or not (moving.size or sample.time_weights[-1]):
                continue
            gate = gates.setdefault(which, Gate(motion, which, engine))
            gate.refuse_company()
            moves = sample.time_weights[-1] + sum(
                seen[k] * engine.rate(sample, int(k)) for k in moving
            )
            shares.append((i, list(gates).index(which), -moves / gate.rate))
        self.fixed = kind([*samples, *(gate.sample for gate in gates.values())])
        self.mix = np.eye(len(self.samples), len(self.fixed.samples))
        for i, j, share in shares:
            self.mix[i, len(self.samples) + j] = share

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        return self.mix @ self.fixed.direct(columns)

    def adjoint(self) -> np.ndarray:
        return self.mix @ self.fixed.adjoint()
