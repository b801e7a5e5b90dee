"""Inertial positions of shapes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Positions:
    """Inertial positions of shapes.

    Attributes
    ----------
    corners : (n, 3) of all hulls
    walls : (f, 2, 3) point and normal
    radii : (s,) of all shapes; walls and boundaries have none
    origins : (s, 3) reference points of the bodies
    coefficients : (c, l) of each law, as in ``Collisions.coefficients``
    axes : (b, 2) first axis of the body of each boundary
    """

    corners: np.ndarray
    walls: np.ndarray
    radii: np.ndarray
    origins: np.ndarray
    coefficients: np.ndarray
    axes: np.ndarray
