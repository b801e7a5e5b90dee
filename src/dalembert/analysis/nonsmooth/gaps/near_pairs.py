"""Shapes at a position, and the gaps of those near each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.shape_velocities import GapDerivatives


@dataclass(frozen=True, eq=False)
class ShapesAt:
    """Balls and walls at a position.

    Attributes
    ----------
    configuration : of the position
    positions : (n, 3) of the balls, then of the walls
    normals : (walls, 3)
    radii : (balls,)
    coefficients : (c, l) laws of contact
    velocities : (n, 6, c) derivatives of the twists by the own speeds of the shapes
    """

    configuration: Configuration
    positions: np.ndarray
    normals: np.ndarray
    radii: np.ndarray
    coefficients: np.ndarray
    velocities: np.ndarray


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

    @property
    def configuration(self) -> Configuration:
        """Configuration of the position."""
        return self.shapes.configuration
