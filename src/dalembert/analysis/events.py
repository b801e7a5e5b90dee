"""Events: sign changes of a measure during a run, located in time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.model.model import Model
from dalembert.symbolic.expression import Expression


@dataclass(frozen=True)
class Event:
    """Something that happens when a measure crosses zero.

    Parameters
    ----------
    measure : name, formula or Expression
    terminal : the run ends there
    direction : +1 rising, −1 falling, 0 both
    """

    measure: str | Expression
    terminal: bool = False
    direction: int = 0

    def __post_init__(self) -> None:
        if self.direction not in (-1, 0, 1):
            raise AnalysisError(f"event direction must be -1, 0 or 1, got {self.direction!r}")

    def expression(self, model: Model) -> Expression:
        if isinstance(self.measure, Expression):
            return self.measure
        try:
            return model[self.measure]
        except KeyError:
            return model.formula(self.measure)

    def crossings(self, values: np.ndarray) -> np.ndarray:
        """Indices ``k`` with a crossing between samples ``k`` and ``k + 1``."""
        before, after = values[:-1], values[1:]
        rising = (before < 0) & (after >= 0)
        falling = (before > 0) & (after <= 0)
        wanted = (rising & (self.direction >= 0)) | (falling & (self.direction <= 0))
        return np.flatnonzero(wanted)


Events = Mapping[str, "Event | str | Expression"]


def as_events(events: Events | None) -> dict[str, Event]:
    """Plain formulas become recording events."""
    return {
        name: event if isinstance(event, Event) else Event(event)
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
    return float(brentq(value, low, high, xtol=1e-13, rtol=1e-14))
