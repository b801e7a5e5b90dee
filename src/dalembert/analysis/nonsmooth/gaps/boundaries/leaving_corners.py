"""Corners that leave the sides of outlines before they would touch them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from dalembert.analysis.nonsmooth.gaps.boundaries.boundaries import PlacedBoundaries
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import HullGeometry
from dalembert.analysis.nonsmooth.gaps.positions import Positions

SLACK = 0.25
"""Share of a step by which a corner may come to the end of a side later than to the side [-]."""
LATEST = 3.0
"""Upper limit of the time in which the gap closes, by the step [-]; later impacts do not act."""
ROUNDING = 1e-9
"""Closing of a gap in a step that counts as rest, by the length of the side [-]."""


class CornersOverSides:
    """Corners of hulls over sides of outlines; arrays are by their pairs.

    Attributes
    ----------
    height, length : of the corners, and of the sides [m]
    before, beyond : distances from the sides along them, by which corners are before their starts
        or beyond their ends; negative over the sides [m]
    convex : (2, n) whether the outline is convex at the starts and at the ends
    """

    def __init__(
        self,
        geometry: HullGeometry,
        placed: PlacedBoundaries,
        at: Positions,
        sides: tuple[np.ndarray, np.ndarray],
        corners: tuple[np.ndarray, np.ndarray],
    ):
        (shape, side), (hull, corner) = sides, corners
        polygons = placed.polygons(shape - placed.first_shape)
        row, counts = np.arange(side.size), polygons.counts
        number = [(side + k) % counts for k in (-1, 0, 1, 2)]
        ends = [polygons.corners[row, k] for k in number]
        edges = [after - start for start, after in pairwise(ends)]
        self.length = length = np.hypot(*edges[1].T)
        tangent = edges[1] / length[:, None]
        place = at.corners[geometry.starts[hull] + corner, :2] - ends[1]
        along = (place * tangent).sum(axis=1)
        self.height = place[:, 0] * tangent[:, 1] - place[:, 1] * tangent[:, 0] - at.radii[hull]
        self.before, self.beyond = -along, along - length
        self.convex = np.array([a[:, 0] * b[:, 1] > a[:, 1] * b[:, 0] for a, b in pairwise(edges)])


def leaving(start: CornersOverSides, end: CornersOverSides) -> np.ndarray:
    """(2, n) mask of the corners that are past convex starts or ends of their sides when their gaps
    close, if they move on as from ``start`` to ``end`` in a step, but for ``SLACK`` of this
    motion."""
    closing = start.height - end.height
    closes = (start.height > 0) & (closing > ROUNDING * start.length)
    share = np.divide(start.height, closing, out=np.zeros(closing.size), where=closes)
    closes &= share < LATEST
    past = np.array([start.before, start.beyond])
    moved = np.array([end.before, end.beyond]) - past
    mask: np.ndarray = closes & start.convex & (moved > 0) & (past + (share + SLACK) * moved > 0)
    return mask


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
