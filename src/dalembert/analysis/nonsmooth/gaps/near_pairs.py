"""Shapes at a position, and the gaps of those near each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.analysis.nonsmooth.gaps.shape_velocities import GapDerivatives


@dataclass(frozen=True, eq=False)
class ShapesAt:
    """Balls and walls at a position.

    Attributes
    ----------
    time, y, p : the position
    positions : (n, 3) of the balls, then of the walls
    normals : (walls, 3)
    radii : (balls,)
    coefficients : (c, l) laws of contact
    velocities : (n, 6, c) derivatives of the twists by the own speeds of the shapes
    """

    time: float
    y: np.ndarray
    p: np.ndarray
    positions: np.ndarray
    normals: np.ndarray
    radii: np.ndarray
    coefficients: np.ndarray
    velocities: np.ndarray

    def is_at(self, time: float, y: np.ndarray, p: np.ndarray) -> bool:
        """Whether this is the position."""
        return self.time == time and np.array_equal(self.y, y) and np.array_equal(self.p, p)


@dataclass(frozen=True, eq=False)
class NearPairs:
    """Pairs of shapes whose gap is within reach.

    Attributes
    ----------
    shapes : ShapesAt
    reach : upper limit of the gaps [m]
    first, second : (n,) numbers of the shapes
    distance, derivatives : gaps, and derivatives of their velocities
    """

    shapes: ShapesAt
    reach: float
    first: np.ndarray
    second: np.ndarray
    distance: np.ndarray
    derivatives: GapDerivatives
