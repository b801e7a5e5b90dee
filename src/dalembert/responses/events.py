"""Responses evaluated at events, whose instants depend on the parameters."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.events import Event, Occurrence
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.options import options
from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression, t
from dalembert.symbolic.once import once
from dalembert.text.arguments import check_arguments


@options
class AtEvent(Response):
    """Value at the instant of an event ``g(t, x, p) = 0``.

    The instant moves with the parameters, ``dt*/dp = −(dg/dp)/ġ``, and so does the value,
    ``dR/dp = dm/dp + ṁ dt*/dp``, with ``d/dp`` at fixed time (Bestle and Eberhard 1992).

    Parameters
    ----------
    event : name of an event declared with the analysis; in Python also an Event
    occurrence : number of the occurrence, from 1

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, 10)))
    >>> top = {"top": da.Event("stone.vy")}
    >>> motion = da.solve_dynamics(system.build(), 3.0, step=0.1, events=top)
    >>> height = da.AtEvent("stone.y", event="top")
    >>> round(da.evaluate(motion, height), 6)  # v²/(2 g)
    5.0
    """

    event: str | Event = ""
    occurrence: int = 1

    def __post_init__(self) -> None:
        if self.event == "":
            raise AnalysisError(f"{self.label}: it needs an event")
        Occurrence(self.event, self.occurrence)

    @property
    def label(self) -> str:
        if self.name:
            return self.name
        measure = super().label.removeprefix("atevent(")
        suffix = "" if self.occurrence == 1 else f" {self.occurrence}"
        return f"at_event({Occurrence(self.event)}{suffix}, {measure}"

    def has_fixed_times(self, motion: Result) -> bool:
        return True

    def sampled(self, motion: Result) -> Result:
        try:
            return _at_event(motion, Occurrence(self.event, self.occurrence))
        except UnsupportedError as error:
            raise UnsupportedError(f"{self.label}: {error}") from None

    def final_event(self, motion: Result) -> Occurrence | None:
        return Occurrence(self.event, self.occurrence)

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(samples[0])

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return np.ones(1)


@once
def _at_event(motion: Result, occurrence: Occurrence) -> Result:
    """The motion at an occurrence, cached for all responses at this event."""
    return motion.analysis.at_event(motion, occurrence)


@check_arguments
def at_event(
    event: str | Event, measure: str | Expression, occurrence: int = 1, name: str = ""
) -> AtEvent:
    """Value of a measure at the n-th occurrence of an event.

    Parameters
    ----------
    event : name of an event declared with the analysis, or an Event
    measure : name, formula or Expression
    occurrence : number n of the occurrence, from 1
    name : label; built from the event and the measure if empty

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> up = system.parameter("up", 10.0, "m/s")
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, up)))
    >>> lands = {"lands": da.Event("stone.y", direction=-1)}
    >>> motion = da.solve_dynamics(system.build(), 3.0, step=0.1, events=lands)
    >>> width = da.at_event("lands", "stone.x")
    >>> round(da.evaluate(motion, width), 6)  # 2 v u/g
    6.0
    >>> round(da.sensitivity(motion, width).item(), 6)  # 2 v/g: the instant moves too
    0.6
    """
    return AtEvent(measure, name, event, occurrence)


@check_arguments
def event_time(event: str | Event, occurrence: int = 1, name: str = "") -> AtEvent:
    """Time of the n-th occurrence of an event [s].

    Parameters
    ----------
    event : name of an event declared with the analysis, or an Event
    occurrence : number n of the occurrence, from 1
    name : label; built from the event if empty

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("drop", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, position=(0, 5)))
    >>> lands = {"lands": da.Event("stone.y")}
    >>> motion = da.solve_dynamics(system.build(), 1.5, step=0.1, events=lands)
    >>> round(da.evaluate(motion, da.event_time("lands")), 9)  # √(2 h/g)
    1.0
    """
    return AtEvent(t, name, event, occurrence)
