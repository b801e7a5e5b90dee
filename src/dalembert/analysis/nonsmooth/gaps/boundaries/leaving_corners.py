"""Corners that leave the sides of outlines before they would touch them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from dalembert.analysis.nonsmooth.gaps.boundaries.boundaries import PlacedBoundaries
from dalembert.analysis.nonsmooth.gaps.corners_over_faces import CornersOverFaces
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import HullGeometry
from dalembert.analysis.nonsmooth.gaps.positions import Positions


def corners_over_sides(
    geometry: HullGeometry,
    placed: PlacedBoundaries,
    at: Positions,
    sides: tuple[np.ndarray, np.ndarray],
    corners: tuple[np.ndarray, np.ndarray],
) -> CornersOverFaces:
    """Corners of hulls over sides of outlines, with the starts and the ends of the sides."""
    (shape, side), (hull, corner) = sides, corners
    polygons = placed.polygons(shape - placed.first_shape)
    row, counts = np.arange(side.size), polygons.counts
    number = [(side + k) % counts for k in (-1, 0, 1, 2)]
    ends = [polygons.corners[row, k] for k in number]
    edges = [after - start for start, after in pairwise(ends)]
    place = at.corners[geometry.starts[hull] + corner, :2] - ends[1]
    convex = np.array([a[:, 0] * b[:, 1] > a[:, 1] * b[:, 0] for a, b in pairwise(edges)])
    return CornersOverFaces.of_sides(place, edges[1], at.radii[hull], convex)


class FollowingContacts:
    """Contacts that take over where a corner of an outline leaves the side of another one: the
    corner at the end of this side, over a side of the first outline next to its corner.

    Parameters
    ----------
    geometry : of one element
    """

    def __init__(self, geometry: HullGeometry):
        numbers = {id(shape): k for k, shape in enumerate(geometry.shapes)}  # last: boundaries
        hulls = len(geometry.hulls)
        self._outline = np.array([numbers[id(shape)] for shape in geometry.shapes])
        self._outline[self._outline < hulls] = -1
        self._is_polygon = np.diff(geometry.starts) > 1
        self._vertex, self._hull = np.full(hulls, -1), dict[tuple[int, int], int]()
        for k, outline in enumerate(self._outline[:hulls].tolist()):
            if outline >= 0:
                self._vertex[k] = sum(other == outline for other in self._outline[:k].tolist())
                self._hull[outline, int(self._vertex[k])] = k

    def available(self, sides: tuple[np.ndarray, np.ndarray], hulls: np.ndarray) -> np.ndarray:
        """(2, n) whether they are among n gaps of sides of outlines with corners of hulls, for the
        starts and the ends of the sides."""
        gaps = set(zip(*(part.tolist() for part in (*sides, hulls)), strict=True))
        mask = np.zeros((2, hulls.size), dtype=bool)
        for k, (shape, side, hull) in enumerate(zip(*sides, hulls, strict=True)):
            outline = int(self._outline[hull])
            if outline < 0:
                mask[:, k] = self._is_polygon[hull]
                continue
            own, others = self._count(int(shape)), self._count(outline)
            vertex = int(self._vertex[hull])
            for end in (0, 1):
                corner = self._hull.get((int(shape), (int(side) + end) % own), -1)
                beside = (vertex, (vertex - 1) % others)
                mask[end, k] = any((outline, other, corner) in gaps for other in beside)
        return mask

    def _count(self, outline: int) -> int:
        """Number of the vertices of an outline."""
        return int(np.count_nonzero(self._outline[: self._vertex.size] == outline))
