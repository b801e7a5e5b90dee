"""Events: sign changes of a measure during a run, located in time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.symbolic.equations.newton import Equations, NewtonSettings, Residual, solve
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import plain_text

T = TypeVar("T")
AGAIN = NewtonSettings(tolerance=1e-15, slack=1e6, max_iterations=20)


@options
class Event:
    """Zero crossing of a measure during a run.

    Parameters
    ----------
    measure : name, formula or Expression
    terminal : whether the run ends there
    direction : +1 rising, −1 falling, 0 both

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("drop", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, position=(0, 5)))
    >>> lands = da.Event("stone.y", terminal=True, direction=-1)
    >>> motion = da.solve_dynamics(system.build(), 3.0, step=0.01, events={"lands": lands})
    >>> motion.events[0].name, round(float(motion.time[-1]), 9)  # √(2 h/g)
    ('lands', 1.0)
    """

    measure: str | Expression
    terminal: bool = False
    direction: int = 0

    def __post_init__(self) -> None:
        if self.direction not in (-1, 0, 1):
            raise AnalysisError(f"event direction must be -1, 0 or 1, got {self.direction!r}")

    def passes(self, rate: float) -> bool:
        """Whether a crossing at this rate of the measure counts."""
        return rate * self.direction >= 0

    def crossings(self, values: np.ndarray) -> np.ndarray:
        """Indices ``k`` with a crossing between samples ``k`` and ``k + 1``."""
        before, after = values[:-1], values[1:]
        rising = (before < 0) & (after >= 0)
        falling = (before > 0) & (after <= 0)
        wanted = (rising & (self.direction >= 0)) | (falling & (self.direction <= 0))
        return np.flatnonzero(wanted)


@dataclass(frozen=True)
class Occurrence:
    """The n-th occurrence of an event.

    Parameters
    ----------
    event : name of an event declared with the analysis, or an Event
    number : 1 for the first occurrence
    """

    event: str | Event
    number: int = 1

    def __post_init__(self) -> None:
        if isinstance(self.number, bool) or not isinstance(self.number, int) or self.number < 1:
            raise AnalysisError(f"{self}: occurrence is {self.number!r}; the first one is 1")

    def declared(self, known: Mapping[str, Event]) -> Event:
        """The event, looked up where it is given by name.

        Raises
        ------
        AnalysisError
            No event of this name.
        """
        if isinstance(self.event, Event):
            return self.event
        if self.event not in known:
            raise AnalysisError(
                f"no event {self.event!r} was declared with the analysis (known: "
                f"{', '.join(known) or 'none'}); declare it, or give an Event"
            )
        return known[self.event]

    def __str__(self) -> str:
        measure = self.event.measure if isinstance(self.event, Event) else self.event
        return measure if isinstance(measure, str) else measure.name or "event"

    def among(self, occurrences: Sequence[T]) -> T:
        """This occurrence out of all occurrences of the event.

        Raises
        ------
        AnalysisError
            The event did not happen so often.
        """
        if self.number > len(occurrences):
            often = {0: "never happened", 1: "happened once"}
            times = often.get(len(occurrences), f"happened {len(occurrences)} times")
            raise AnalysisError(
                f"event {str(self)!r} {times} in this run, and occurrence {self.number} was "
                "requested; use an earlier one, check the event's direction, or run longer"
            )
        return occurrences[self.number - 1]


Events = Mapping[str, Event | str | Expression]


def as_events(events: Events | None) -> dict[str, Event]:
    """Events by name; plain formulas become events that are recorded only."""
    return {
        plain_text(name, "event"): event if isinstance(event, Event) else Event(event)
        for name, event in (events or {}).items()
    }


def locate(value: Callable[[float], float], low: float, high: float) -> float:
    """Root of ``value`` between ``low`` and ``high`` (Brent)."""
    from scipy.optimize import brentq

    f_low, f_high = value(low), value(high)
    if f_low == 0.0:
        return low
    if f_high == 0.0 or f_low * f_high > 0:
        return high
    return float(brentq(value, low, high, xtol=1e-12 * (high - low), rtol=1e-14, maxiter=1000))


def locate_again(
    value: Callable[[float], float],
    rate: Callable[[float], float],
    near: float,
    name: str,
    span: float,
) -> float:
    """Root of ``value`` after a small change of parameters, by Newton's method.

    Parameters
    ----------
    near : root before the change [s]
    span : time span that scales the residual [s]

    Raises
    ------
    AnalysisError
        No root was found.
    """
    solution = solve(_Crossing(value, rate, span), np.array([near]), AGAIN)
    if not solution.accepted:
        raise AnalysisError(f"event {name!r} does not happen again near where it happened before")
    return float(solution.x[0])


class _Crossing(Equations[np.ndarray]):
    """``m(t) = 0``; the residual is scaled by the change of ``m`` over a span of time."""

    def __init__(
        self, value: Callable[[float], float], rate: Callable[[float], float], span: float
    ):
        self.value, self.rate, self.span = value, rate, span

    def residual(self, x: np.ndarray) -> Residual:
        time = float(x[0])
        return Residual(np.array([self.value(time)]), abs(self.rate(time)) * self.span)

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        return -residual.value / (self.rate(float(x[0])) or np.nan)
