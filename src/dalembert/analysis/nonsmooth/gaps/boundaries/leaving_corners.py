"""Corners that leave the sides of outlines before they would touch them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from dalembert.analysis.nonsmooth.gaps.boundaries.boundaries import PlacedBoundaries
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import HullGeometry
from dalembert.analysis.nonsmooth.gaps.positions import Positions

SLACK = 0.25
"""Share of a step by which a corner may come to the end of a side later than to the side [-]."""


class CornersOverSides:
    """Corners of hulls over sides of outlines; arrays are by their pairs.

    Attributes
    ----------
    height : of the corners [m]
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
        length = np.hypot(*edges[1].T)
        tangent = edges[1] / length[:, None]
        place = at.corners[geometry.starts[hull] + corner, :2] - ends[1]
        along = (place * tangent).sum(axis=1)
        self.height = place[:, 0] * tangent[:, 1] - place[:, 1] * tangent[:, 0] - at.radii[hull]
        self.before, self.beyond = -along, along - length
        self.convex = np.array([a[:, 0] * b[:, 1] > a[:, 1] * b[:, 0] for a, b in pairwise(edges)])


def leaving(start: CornersOverSides, end: CornersOverSides) -> np.ndarray:
    """(n,) mask of the corners that are past convex ends of their sides when their gaps close, if
    they move on as from ``start`` to ``end`` in a step, but for ``SLACK`` of this motion."""
    closing = start.height - end.height
    closes = (start.height > 0) & (closing > 0)
    share = np.divide(start.height, closing, out=np.zeros(closing.size), where=closes)
    mask = np.zeros(closing.size, dtype=bool)
    for past, later, convex in (
        (start.before, end.before, start.convex[0]),
        (start.beyond, end.beyond, start.convex[1]),
    ):
        moved = later - past
        mask |= closes & convex & (moved > 0) & (past + (share + SLACK) * moved > 0)
    return mask
