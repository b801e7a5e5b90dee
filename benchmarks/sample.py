"""Measured numbers with their spread."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

PREFIXES = {"s": ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))}


@dataclass(frozen=True)
class Sample:
    """Median and quartiles of repeated measurements.

    Attributes
    ----------
    unit : ``"s"`` is shown with a prefix
    note : what else is to be told
    """

    median: float
    low: float
    high: float
    unit: str
    note: str = ""

    @classmethod
    def of(cls, values: Sequence[float], unit: str, note: str = "") -> Sample:
        low, median, high = np.quantile(np.asarray(values, float), [0.25, 0.5, 0.75])
        return cls(float(median), float(low), float(high), unit, note)

    def __str__(self) -> str:
        known = PREFIXES.get(self.unit, ((1.0, self.unit),))
        factor, unit = next((f for f in known if self.median >= f[0]), known[-1])
        spread = (self.high - self.low) / 2 / self.median if self.median else 0.0
        text = f"{self.median / factor:.3g} {unit}".rstrip()
        text += f" ± {100 * spread:.0f} %" if self.high > self.low else ""
        return f"{text} ({self.note})" if self.note else text


@dataclass
class Row:
    """A line of the table: a quantity, and what it is for each solver."""

    case: str
    quantity: str
    samples: dict[str, Sample] = field(default_factory=dict)
