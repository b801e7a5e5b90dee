"""What the designs of a batch have in common: instants, and measures at them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression

SAME = 1e-12
"""Difference of two times, relative to the run, that are the same."""


class Samples(Protocol):
    """Measures of all designs at the same instants; what a design has not reached is NaN."""

    @property
    def time(self) -> np.ndarray:
        """(K,) instants, or numbers of load cases."""
        ...

    def table(self, measures: Sequence[Expression]) -> np.ndarray:
        """(designs, rows, K) all components of measures, one above the other."""
        ...


@dataclass(eq=False)
class Gathered:
    """Results that were found one by one.

    Attributes
    ----------
    count : of all designs
    results : number of the design → its result, of those that have one
    """

    count: int
    results: Mapping[int, Result]

    @cached_property
    def time(self) -> np.ndarray:
        """Instants of those that ended as asked, else of the one that came furthest."""
        done = [r for r in self.results.values() if r.status.success] or list(self.results.values())
        return max((r.time for r in done), key=np.size, default=np.zeros(0))

    def table(self, measures: Sequence[Expression]) -> np.ndarray:
        rows = sum(len(measure) for measure in measures)
        found = np.full((self.count, rows, self.time.size), np.nan)
        for k, result in self.results.items():
            place(found[k], self.time, result, measures)
        return found


def place(
    table: np.ndarray, time: np.ndarray, result: Result, measures: Sequence[Expression]
) -> None:
    """Write the measures of one result into (rows, K) where its instants are."""
    columns = places(time, result.time)
    known = columns >= 0
    values = [np.asarray(result.values(m), dtype=float) for m in measures]
    rows = np.vstack([v.reshape(result.time.size, -1).T for v in values])
    table[:, columns[known]] = rows[:, known]


def places(time: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Number of each wanted instant among some, −1 where it is none of them."""
    if not time.size or not wanted.size:
        return np.full(wanted.size, -1)
    slack = SAME * max(abs(float(time[0])), abs(float(time[-1])))
    after = np.clip(np.searchsorted(time, wanted), 0, time.size - 1)
    before = np.maximum(after - 1, 0)
    nearer = abs(time[before] - wanted) < abs(time[after] - wanted)
    found = np.where(nearer, before, after)
    return np.where(abs(time[found] - wanted) <= slack, found, -1)
