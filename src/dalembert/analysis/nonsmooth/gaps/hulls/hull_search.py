"""Search for near features of hulls, cylinders and walls."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.gaps.bounding_balls import (
    FEW,
    bounding_balls,
    near_balls,
    within_reach,
)
from dalembert.analysis.nonsmooth.gaps.cylinders.cylinder_features import cylinder_features
from dalembert.analysis.nonsmooth.gaps.cylinders.cylinder_pairs import (
    features_at_walls,
    features_of_cylinders,
)
from dalembert.analysis.nonsmooth.gaps.cylinders.cylinders import Cylinders
from dalembert.analysis.nonsmooth.gaps.cylinders.standing_ends import on_points_alone
from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps.hulls.compiled_features import CompiledFeatures
from dalembert.analysis.nonsmooth.gaps.hulls.feature_pairs import EvaluatePairs, Pairs, some_pairs
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import HullGeometry, Solids
from dalembert.analysis.nonsmooth.gaps.hulls.outline_corners import OutlineCorners
from dalembert.analysis.nonsmooth.gaps.hulls.planar_features import Rows, planar_features
from dalembert.analysis.nonsmooth.gaps.hulls.spatial_features import spatial_features
from dalembert.analysis.nonsmooth.gaps.positions import Positions
from dalembert.analysis.nonsmooth.gaps.terrain.terrain_search import TerrainSearch
from dalembert.elements.contact.shapes import Round


class HullSearch:
    """Near features of the shapes of one element.

    Parameters
    ----------
    geometry : HullGeometry
    """

    def __init__(self, geometry: HullGeometry):
        self.geometry = geometry
        corners = int(geometry.starts[-1])
        self._compiled = CompiledFeatures(geometry.form_tables, corners, geometry.dimension)
        self._round = np.array([isinstance(shape, Round) for shape in geometry.shapes])
        points = [len(hull.corners) == 1 and hull.is_sharp for hull in geometry.hulls]
        self._point = np.pad(points, (0, len(geometry.shapes) - len(points)))
        self._end = np.array([shape.boundary() is not None for shape in geometry.shapes])
        self._outlines = OutlineCorners(geometry)
        self._terrain = np.isin(np.arange(len(geometry.shapes)), geometry.terrains)
        hulls = self._searchable = np.flatnonzero(~self._terrain[: len(geometry.hulls)])
        self._candidates: np.ndarray | None = None
        if hulls.size <= FEW:
            self._candidates = self._touching(hulls[np.stack(np.triu_indices(hulls.size, 1))])
        self._terrains = [
            TerrainSearch(geometry, k, hulls[self._may_touch(np.full(hulls.size, k), hulls)])
            for k in geometry.terrains
        ]

    def __call__(self, at: Positions, reach: float, evaluate: EvaluatePairs) -> list[Pairs]:
        """Features that touch within reach."""
        on_terrain = [pairs for search in self._terrains for pairs in search(at, reach, evaluate)]
        hulls = self._hulls(at, reach, evaluate)
        if self._end.any():
            hulls = [self._outlines.touching(pairs, at, evaluate) for pairs in hulls]
        listed = [*self._walls(at, reach), *hulls, *on_terrain]
        if self.geometry.has_compliant_ends:
            listed = on_points_alone(listed, self.geometry.flat_ends, self.geometry.compliant)
        return [pairs for pairs in listed if pairs.first.size]

    def _touching(self, pairs: np.ndarray) -> np.ndarray:
        """Those of the pairs (2, n) of shapes that may touch."""
        touching: np.ndarray = pairs[:, self._may_touch(*pairs)]
        return touching

    def _may_touch(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Mask of pairs of shapes that may touch, not both of balls, nor corners of boundaries and
        points, which do not hit each other."""
        point, end = self._point, self._end
        apart = ~(self._round[first] & self._round[second])
        apart &= ~(end[first] & point[second]) & ~(point[first] & end[second])
        return apart & self.geometry.may_touch(first, second)

    def _walls(self, at: Positions, reach: float) -> list[Pairs]:
        """Corners and rims near walls."""
        if not len(at.walls):
            return []
        starts, count = self.geometry.starts, len(self.geometry.hulls)
        hull = np.repeat(np.arange(count), np.diff(starts))
        normals, points = at.walls[:, 1], at.walls[:, 0]
        floors = (normals * points).sum(axis=1)[:, None]
        heights = normals @ at.corners.T - floors
        others = self.geometry.flat_ends[hull] | self._terrain[hull]
        wall, corner = np.nonzero((heights - at.radii[hull] <= reach) & ~others)
        first, second = wall + count, hull[corner]
        touching = self._may_touch(first, second) & ~self._round[second]
        pairs = Pairs(Feature.WALL, first, second, 0 * first, corner - starts[second])
        tables = [some_pairs(pairs, touching)] if touching.any() else []
        cylinders = np.flatnonzero(self.geometry.flat_ends[:count])
        first, second = (n.ravel() for n in np.meshgrid(count + np.arange(len(floors)), cylinders))
        touching = self._may_touch(first, second)
        first, second = first[touching], second[touching]
        if not first.size:
            return tables
        solids, walls = self.geometry.solids(second, at), first - count
        assert isinstance(solids, Cylinders)
        for feature, row, other in features_at_walls(solids, normals[walls], floors[walls], reach):
            if row.size:
                tables.append(Pairs(feature, first[row], second[row], 0 * row, other))
        return tables

    def _hulls(self, at: Positions, reach: float, evaluate: EvaluatePairs) -> list[Pairs]:
        """Near features of hulls."""
        starts = self.geometry.starts
        centers, radii = bounding_balls(at.corners, starts)
        radii = radii + np.where(self.geometry.flat_ends, 0.0, at.radii)[: radii.size]
        hulls, candidates = self._searchable, self._candidates
        if candidates is None:
            near = near_balls(centers[hulls], radii[hulls], reach)
            candidates = self._touching(hulls[near])
        else:
            candidates = within_reach(candidates, centers, radii, reach)
        first, second = candidates
        if not first.size:
            return []
        listed: list[Pairs] = []
        if self._compiled.available:
            flat = self.geometry.flat_ends
            own = ~(flat[first] | flat[second])
            listed = self._sharp_hulls(first[own], second[own], at, reach)
            first, second = first[~own], second[~own]
        return [*listed, *self._searched(first, second, at, evaluate)] if first.size else listed

    def _sharp_hulls(
        self, first: np.ndarray, second: np.ndarray, at: Positions, reach: float
    ) -> list[Pairs]:
        """Near features of hulls that are no cylinders, in machine code."""
        rounded, radii = self.geometry.rounded, at.radii
        either = rounded[first] | rounded[second]
        limits = reach + radii[first] + radii[second]
        rows = self._compiled(at.corners, first, second, either, limits)
        return [_pairs_of(part, first, second) for part in rows]

    def _searched(
        self, first: np.ndarray, second: np.ndarray, at: Positions, evaluate: EvaluatePairs
    ) -> list[Pairs]:
        """Near features of hulls, which may be cylinders."""
        if self.geometry.dimension == 2:
            polygons = self.geometry.polygons(np.concatenate([first, second]), at)
            rounded = self.geometry.rounded[first] | self.geometry.rounded[second]
            rows = planar_features(polygons, rounded)
            return [_pairs_of(part, first, second) for part in rows if part[1].size]
        tables: dict[Feature, list[np.ndarray]] = {}
        for pairs, one, another in self.geometry.batches(first, second, at):
            i, j = first[pairs], second[pairs]
            for listed in self._features(i, j, one, another, evaluate):
                part = _pairs_of(listed, i, j)
                table = np.stack([part.first, part.second, part.own, part.other])
                tables.setdefault(part.feature, []).append(table)
        joined = ((feature, np.hstack(parts)) for feature, parts in tables.items())
        return [Pairs(feature, *table) for feature, table in joined if table.size]

    def _features(
        self, i: np.ndarray, j: np.ndarray, one: Solids, another: Solids, evaluate: EvaluatePairs
    ) -> list[Rows]:
        """Features that touch of spatial hulls ``i`` and ``j`` of equal forms."""
        rounded = self.geometry.rounded

        def evaluated(rows: Rows) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            return evaluate(_pairs_of(rows, i, j))

        if isinstance(one, Cylinders):
            if isinstance(another, Cylinders):
                return features_of_cylinders(one, another, evaluated)
            return cylinder_features(one, another, rounded[j], evaluated)
        if isinstance(another, Cylinders):
            rows = self._features(j, i, another, one, evaluate)
            return [
                (feature, row, ~swapped, own, other) for feature, row, swapped, own, other in rows
            ]
        return spatial_features(one, another, rounded[i] | rounded[j])


def _pairs_of(rows: Rows, first: np.ndarray, second: np.ndarray) -> Pairs:
    """Features of pairs of hulls."""
    feature, row, swapped, own, other = rows
    i, j = first[row], second[row]
    return Pairs(feature, np.where(swapped, j, i), np.where(swapped, i, j), own, other)
