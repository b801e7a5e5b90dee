"""Natural units of a mechanism, which make all thresholds dimensionless.

A tolerance in metres suits machines of about a metre only. A characteristic length, mass, time and
force make every compared number dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

RESOLUTION = 32 * np.finfo(float).eps
"""Rounding errors of gaps, relative to the largest coordinate [-]."""


@dataclass(frozen=True, eq=False)
class Scales:
    """Characteristic sizes of a mechanism; 1 by default.

    Attributes
    ----------
    length : largest lever arm or prescribed length L [m]
    size : size of the bodies, which no position changes: the largest lever arm, or the extent of
        all bodies with contact shapes side by side; L without any, and at most L [m]
    distance : largest coordinate of a position at the guesses [m]
    mass : largest mass, or inertia over L² [kg]
    time : from the fastest initial speed, or √(mass · L / force) [s]
    force : largest applied force at the guesses, or stiffness times L [N]
    coordinates : (n_y,) L for metres, 1 for radians; else the change that moves a point by L
    displacements : (n,) the same for displacements
    rows : (m,) of the constraint equations, L for metres and 1 for radians
    """

    length: float
    size: float
    distance: float
    mass: float
    time: float
    force: float
    coordinates: np.ndarray
    displacements: np.ndarray
    rows: np.ndarray

    @property
    def speeds(self) -> np.ndarray:
        """(n,) scales of the speeds."""
        return self.displacements / self.time

    @property
    def energy(self) -> float:
        """``force · L`` [J]."""
        return self.force * self.length

    @property
    def efforts(self) -> np.ndarray:
        """(n,) scales of generalised forces, each of which does the work ``energy``."""
        return self.energy / self.displacements

    @property
    def multipliers(self) -> np.ndarray:
        """(m,) scales of the multipliers."""
        return self.energy / self.rows

    def of(self, unit: str) -> float:
        """Scale of a position-level quantity in metres or radians."""
        return self.length if unit == "m" else 1.0

    def gap_threshold(self, share: float) -> float:
        """A share of the size of the bodies, at least the rounding errors of gaps [m]."""
        return max(share * self.size, RESOLUTION * self.distance)

    @classmethod
    def units(cls, coordinates: int, speeds: int, rows: int) -> Scales:
        """Unit scales, without any information."""
        return cls(*6 * (1.0,), np.ones(coordinates), np.ones(speeds), np.ones(rows))

    def with_rows(self, rows: list[int]) -> Scales:
        """Scales with some of the constraint equations."""
        return replace(self, rows=self.rows[rows])
