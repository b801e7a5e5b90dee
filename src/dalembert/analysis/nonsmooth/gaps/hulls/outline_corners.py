"""Corners of polygons with dents that other shapes can touch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps.hulls.feature_pairs import EvaluatePairs, Pairs, some_pairs
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import HullGeometry
from dalembert.analysis.nonsmooth.gaps.positions import Positions

ROUNDING = 1e-9
"""Sine of the angle beyond the normals of both sides within which a ball touches a corner."""
FLUSH = 0.7
"""The same for edges, which may be nearly parallel to a side."""
LOWER = 0.1
"""Sine of the slope of an edge by which the next corner may be lower than one beyond a side."""


class OutlineCorners:
    """Corners of the outlines of one element, which are hulls of one point.

    A corner touches along normals between those of its sides: a ball beside a corner touches the
    side alone, and a corner of a dent touches nothing before both sides do.

    Parameters
    ----------
    geometry : HullGeometry
    """

    def __init__(self, geometry: HullGeometry):
        self._geometry, count = geometry, len(geometry.hulls)
        self._beside = np.full((count, 2), -1)
        number: dict[int, list[int]] = {}
        for k, shape in enumerate(geometry.shapes[:count]):
            number.setdefault(id(shape), []).append(k)
        for hulls in number.values():
            boundary = geometry.shapes[hulls[0]].boundary()
            if boundary is not None and boundary.vertices:
                first = geometry.starts[hulls]
                self._beside[hulls] = np.stack([np.roll(first, 1), np.roll(first, -1)], axis=1)
        starts, counts = geometry.starts[:-1], np.diff(geometry.starts)
        corner, size = np.arange(geometry.starts[-1]), np.repeat(counts, counts)
        first = np.repeat(starts, counts)
        number = (corner - first)[:, None] + np.array([-1, 1])
        self._next = first[:, None] + number % size[:, None]
        corners = self._beside[:, 0] >= 0
        self._next[starts[corners]] = self._beside[corners]

    @property
    def _is_corner(self) -> np.ndarray:
        """(s,) mask of the shapes."""
        others = len(self._geometry.shapes) - len(self._beside)
        return np.pad(self._beside[:, 0] >= 0, (0, others))

    def convex(self, hulls: np.ndarray, at: Positions) -> np.ndarray:
        """Mask of hulls that are no corners of dents."""
        rows = np.flatnonzero(self._is_corner[hulls])
        mask = np.ones(hulls.size, dtype=bool)
        before, after = self._sides(hulls[rows], at)
        mask[rows] = before[:, 1] * after[:, 0] - before[:, 0] * after[:, 1] > 0
        return mask

    def touching(self, pairs: Pairs, at: Positions, evaluate: EvaluatePairs) -> Pairs:
        """The pairs without those of corners that touch by their sides.

        A corner behind a face whose normal is beyond those of its sides, as near the end of a face
        that it has entered, touches the face of the same hull that is the least behind it.
        """
        if pairs.feature is Feature.FACE:
            pairs = self._facing(pairs, at)
        selected = np.ones(pairs.first.size, dtype=bool)
        corners = self._is_corner
        for hulls, sign in ((pairs.first, 1.0), (pairs.second, -1.0)):
            rows = np.flatnonzero(corners[hulls])
            if rows.size:
                normal = sign * evaluate(some_pairs(pairs, rows))[2][:, :2]
                tolerance = ROUNDING if pairs.feature is Feature.CORNERS else FLUSH
                along = [(side * normal).sum(axis=1) for side in self._sides(hulls[rows], at)]
                outside = np.maximum(*along) > tolerance
                selected[rows] &= self.convex(hulls[rows], at) & ~outside
        return some_pairs(pairs, selected)

    def _facing(self, pairs: Pairs, at: Positions) -> Pairs:
        """The pairs with other faces of their hulls for corners within these that the faces do not
        face."""
        rows = np.flatnonzero(self._is_corner[pairs.second] & ~self._is_corner[pairs.first])
        if not rows.size:
            return pairs
        hulls, corner = pairs.first[rows], pairs.second[rows]
        polygons = self._geometry.polygons(hulls, at)
        place = at.corners[self._geometry.starts[corner], :2]
        between = place[:, None] - polygons.corners
        tangents = polygons.normals[..., ::-1] * (-1.0, 1.0)
        heights, along = ((between * axes).sum(axis=2) for axes in (polygons.normals, tangents))
        number = np.arange(polygons.corners.shape[1])
        after = (number + 1) % polygons.counts[:, None]
        ends = np.take_along_axis(polygons.corners, after[..., None], axis=1) - polygons.corners
        inside = (along >= 0) & (along <= (ends * tangents).sum(axis=2)) & polygons.has_edge
        sides = self._sides(corner, at)
        beyond = [-(polygons.normals * side[:, None]).sum(axis=2) for side in sides]
        faced = np.maximum(*beyond) <= FLUSH
        row = np.arange(rows.size)
        other = np.where(inside & faced, heights, -np.inf).argmax(axis=1)
        inner = np.where(polygons.has_edge, heights, -np.inf).max(axis=1) < 0
        change = inner & ~faced[row, pairs.own[rows]] & (inside & faced)[row, other]
        own = pairs.own.copy()
        own[rows[change]] = other[change]
        return replace(pairs, own=own)

    def lowest(self, corners: np.ndarray, normals: np.ndarray, at: Positions) -> np.ndarray:
        """Mask of corners of hulls below which, along normals (n, 2), no next corner is."""
        away = at.corners[self._next[corners], :2] - at.corners[corners, None, :2]
        heights = (away * normals[:, None]).sum(axis=2)
        mask: np.ndarray = (heights >= -LOWER * np.linalg.norm(away, axis=2)).all(axis=1)
        return mask

    def _sides(self, hulls: np.ndarray, at: Positions) -> tuple[np.ndarray, np.ndarray]:
        """Unit vectors (n, 2) from corners to those before and after them."""
        own = at.corners[self._geometry.starts[hulls], None, :2]
        between = at.corners[self._beside[hulls], :2] - own
        length = np.linalg.norm(between, axis=2, keepdims=True)
        unit = between / np.where(length > 0, length, 1.0)
        return unit[:, 0], unit[:, 1]
