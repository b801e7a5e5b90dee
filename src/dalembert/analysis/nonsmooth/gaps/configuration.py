"""Configuration of a model: its coordinates at an instant, with its parameters."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Configuration(NamedTuple):
    """Instant, coordinates and parameters, at which gaps are evaluated.

    Attributes
    ----------
    time : [s]
    y : (n_y,) coordinates
    p : (n_p,) parameters
    """

    time: float
    y: np.ndarray
    p: np.ndarray

    def equals(self, other: Configuration) -> bool:
        """Whether all values are equal."""
        same = self.time == other.time and np.array_equal(self.y, other.y)
        return same and np.array_equal(self.p, other.p)

    @property
    def key(self) -> tuple[float, bytes, bytes]:
        """The values as bytes, which are the same for the same values."""
        return self.time, self.y.tobytes(), self.p.tobytes()

    def copy(self) -> Configuration:
        """The same values in arrays of their own."""
        return Configuration(self.time, self.y.copy(), self.p.copy())
