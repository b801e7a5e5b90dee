"""Values of gaps, their changes, or weights of these."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class GapChanges:
    """Values of gaps, their changes, or weights of these.

    Attributes
    ----------
    distance : (n, …) ``g``
    before, after : (n, k, …) ``u`` for both speeds
    laws : (n, c, …) coefficients: ``FIRST``, and friction of each group
    """

    distance: np.ndarray
    before: np.ndarray
    after: np.ndarray
    laws: np.ndarray

    @classmethod
    def zero(cls, count: int, width: int, laws: int, *columns: int) -> GapChanges:
        """Zeros, ``columns`` of each."""
        shapes = (count,), (count, width), (count, width), (count, laws)
        return cls(*(np.zeros((*shape, *columns)) for shape in shapes))

    def like(self, columns: int) -> GapChanges:
        """Zeros of the same shapes, ``columns`` of each."""
        return GapChanges.zero(*self.before.shape[:2], self.laws.shape[1], columns)

    def add(self, rows: np.ndarray, other: GapChanges) -> None:
        """Add to some rows; gaps with fewer groups of friction have fewer coefficients."""
        for name in ("distance", "before", "after"):
            getattr(self, name)[rows] += getattr(other, name)
        self.laws[rows, : other.laws.shape[1]] += other.laws

    def some(self, rows: np.ndarray) -> GapChanges:
        """Some rows."""
        return GapChanges(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))
