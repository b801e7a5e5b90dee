"""Places near the sides of polygons that may have dents."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from dalembert.analysis.nonsmooth.gaps.hulls.planar_features import Polygons

ROUNDING = 1e-12
"""Extension of a side beyond its ends, by its length."""
END = 1e-6
"""Distance from the ends of a side at which a corner over it may pass an end, by its length [-]."""
AHEAD = 0.7
"""Cosine of the angle to the normal of a side at which a corner beyond its end still faces it."""


class OutlineSides:
    """One place near each of m polygons; arrays (m, c) are by their sides.

    Parameters
    ----------
    polygons : m polygons
    places : (m, 2)
    """

    def __init__(self, polygons: Polygons, places: np.ndarray):
        start, normal, self._real = polygons.corners, polygons.normals, polygons.has_edge
        number = np.arange(start.shape[1])
        self._after = (number + 1) % polygons.counts[:, None]
        self._before = (number - 1) % polygons.counts[:, None]
        tangent = np.stack([-normal[..., 1], normal[..., 0]], axis=2)
        between = places[:, None] - start
        edge = np.take_along_axis(start, self._after[..., None], axis=1) - start
        self.length = (edge * tangent).sum(axis=2)
        before = np.take_along_axis(normal, self._before[..., None], axis=1)
        self._dent = (before * tangent).sum(axis=2) > 0  # at the starts
        self.height = (between * normal).sum(axis=2)
        self._along = (between * tangent).sum(axis=2)

    @cached_property
    def _beyond(self) -> np.ndarray:
        """Distances from the ends along the sides; zero above a side."""
        beyond: np.ndarray = np.maximum(np.maximum(-self._along, self._along - self.length), 0.0)
        return beyond

    @cached_property
    def distance(self) -> np.ndarray:
        """Distances of the places from the sides."""
        return np.where(self._real, np.hypot(self.height, self._beyond), np.inf)

    @cached_property
    def valid(self) -> np.ndarray:
        """Sides that a place is in front of, or behind and nearer to than to others."""
        nearest = self.distance.min(axis=1)[:, None]
        behind = -self.height <= nearest + ROUNDING * self.length
        valid: np.ndarray = self._real & ((self.height >= 0) | behind)
        return valid

    @cached_property
    def above(self) -> np.ndarray:
        """Sides between the ends of which a place is."""
        above: np.ndarray = self._beyond <= ROUNDING * self.length
        return above

    @cached_property
    def inside(self) -> np.ndarray:
        """Sides above which a place is, and not at an end."""
        least = np.minimum(self._along, self.length - self._along)
        inside: np.ndarray = least >= END * self.length
        return inside

    @cached_property
    def faced(self) -> np.ndarray:
        """Sides that corners face beyond an end, where the next side is lower below them."""
        higher_after = self.height >= np.take_along_axis(self.height, self._after, axis=1)
        higher_before = self.height > np.take_along_axis(self.height, self._before, axis=1)
        higher = np.where(self._along > self.length, higher_after, higher_before)
        faced: np.ndarray = higher & (self.height >= AHEAD * self.distance)
        return faced

    @cached_property
    def dented(self) -> np.ndarray:
        """Sides that end in the dent that is the nearest point to a place in the material."""
        after = np.take_along_axis(self._dent, self._after, axis=1)
        dent = np.where(self._along > self.length, after, self._dent)
        nearest = self.distance.min(axis=1)[:, None]
        dented: np.ndarray = dent & (self.distance <= nearest + ROUNDING * self.length)
        return dented

    def touched(self, radii: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        """Rows and numbers of the sides that balls of these radii touch.

        A ball touches a side above which its centre is, a corner also one that it faces. Behind a
        dent no side is below them: both sides of it bound their motion.
        """
        reached = self.above | self.dented | (self.faced & (radii == 0)[:, None])
        row, side = np.nonzero(reached & self.valid & (self.height - radii[:, None] <= reach))
        return row, side
