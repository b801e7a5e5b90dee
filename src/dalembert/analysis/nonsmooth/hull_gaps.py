"""Gaps among rounded convex hulls and walls, with a numerical search for near features."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.nonsmooth.bounding_balls import bounding_balls, near_balls
from dalembert.analysis.nonsmooth.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps import SymbolicGap
from dalembert.analysis.nonsmooth.hull_geometry import Pairs, Positions
from dalembert.analysis.nonsmooth.planar_features import planar_features
from dalembert.analysis.nonsmooth.searched_gaps import LastPosition, SearchedGaps
from dalembert.analysis.nonsmooth.spatial_features import spatial_features
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.shapes import Round
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model


class HullGaps(SearchedGaps):
    """Gaps of one ``Collisions`` element, except those of balls with balls and walls.

    A numerical search selects features of near hulls; the gap of two features is a smooth function.

    Parameters
    ----------
    model : Model
    element : Collisions
    """

    def __init__(self, model: Model, element: Collisions):
        super().__init__(model, element)
        geometry = self.geometry
        self._round = np.array([isinstance(shape, Round) for shape in geometry.shapes])
        points = [len(hull.corners) == 1 and hull.is_sharp for hull in geometry.hulls]
        self._point = np.pad(points, (0, len(geometry.shapes) - len(points)))
        self._end = np.array([shape.boundary() is not None for shape in geometry.shapes])
        features = [max(len(h.corners), 2 * len(h.edges), len(h.faces)) for h in geometry.hulls]
        self._radix = max(features), len(geometry.shapes)

    def within(self, last: LastPosition, groups: tuple[int, ...]) -> list[Contacts]:
        at, reach = last.at, last.reach
        pairs = [self._with_ends(p) for p in (*self._walls(at, reach), *self._hulls(at, reach))]
        return [self._contacts(part, last, groups) for part in pairs if part.first.size]

    def _with_ends(self, pairs: Pairs) -> Pairs:
        """The pairs without corners of endless shapes."""
        endless, feature = self.geometry.endless, pairs.feature
        if not endless.any() or feature is Feature.EDGES:
            return pairs
        corners = endless[pairs.second]
        if feature is Feature.CORNERS:
            corners |= endless[pairs.first]
        return _some(pairs, ~corners)

    def symbolic(self, key: int) -> SymbolicGap:
        pairs = self._pairs_of(np.array([key]))
        columns = self.geometry.symbolic_columns(pairs)
        return self.formula(pairs.feature, columns, int(pairs.first[0]), int(pairs.second[0]))

    def points(
        self, time: float, y: np.ndarray, p: np.ndarray, keys: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        at = self.geometry.positions(time, y, p)
        places = np.zeros((keys.size, 3))
        directions = np.zeros((keys.size, 3, self.dimension))
        kinds = keys // self._first_key(Feature(1))
        for kind in np.unique(kinds):
            own = kinds == kind
            places[own], directions[own] = self._evaluate(self._pairs_of(keys[own]), at)[2:]
        return places, directions

    # search --------------------------------------------------------------------------------------
    def _may_touch(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Mask of pairs of shapes that may touch, not both of balls, nor corners of boundaries and
        points, which do not hit each other."""
        solid = ~(self._round[first] & self._round[second])
        solid &= ~(self._end[first] & self._point[second]) & ~(
            self._point[first] & self._end[second]
        )
        return solid & self.geometry.may_touch(first, second)

    def _walls(self, at: Positions, reach: float) -> list[Pairs]:
        """Corners near walls."""
        starts, count = self.geometry.starts, len(self.geometry.hulls)
        hull = np.repeat(np.arange(count), np.diff(starts))
        normals, points = at.walls[:, 1], at.walls[:, 0]
        heights = normals @ at.corners.T - (normals * points).sum(axis=1)[:, None]
        wall, corner = np.nonzero(heights - at.radii[hull] <= reach)
        first, second = wall + count, hull[corner]
        touching = self._may_touch(first, second) & ~self._round[second]
        pairs = Pairs(Feature.WALL, first, second, 0 * first, corner - starts[second])
        return [_some(pairs, touching)] if touching.any() else []

    def _hulls(self, at: Positions, reach: float) -> list[Pairs]:
        """Near features of hulls."""
        starts = self.geometry.starts
        centers, radii = bounding_balls(at.corners, starts)
        first, second = near_balls(centers, radii + at.radii[: radii.size], reach)
        touching = self._may_touch(first, second)
        first, second = first[touching], second[touching]
        if not first.size:
            return []
        rounded = self.geometry.rounded[first] | self.geometry.rounded[second]
        search = planar_features if self.dimension == 2 else spatial_features
        tables: dict[Feature, list[np.ndarray]] = {}
        for pairs, one, another in self.geometry.batches(first, second, at):
            i, j = first[pairs], second[pairs]
            for feature, row, swapped, own, other in search(one, another, rounded[pairs]):
                a, b = np.where(swapped, j[row], i[row]), np.where(swapped, i[row], j[row])
                tables.setdefault(feature, []).append(np.stack([a, b, own, other]))
        joined = ((feature, np.hstack(parts)) for feature, parts in tables.items())
        return [Pairs(feature, *table) for feature, table in joined if table.size]

    # gaps of pairs -------------------------------------------------------------------------------
    def _contacts(self, pairs: Pairs, last: LastPosition, groups: tuple[int, ...]) -> Contacts:
        """Gaps of pairs within reach."""
        gaps = self._evaluate(pairs, last.at)
        near = gaps[0] <= last.reach
        pairs, gaps = _some(pairs, near), [part[near] for part in gaps]
        return self.contacts(last, pairs.first, pairs.second, gaps, self._keys(pairs), groups)

    def _evaluate(self, pairs: Pairs, at: Positions) -> list[np.ndarray]:
        return self.evaluate(pairs.feature, self.geometry.columns(pairs, at))

    def _first_key(self, feature: Feature) -> int:
        """The smallest key of a kind of features."""
        features, shapes = self._radix
        return int(feature) * (shapes * features) ** 2

    def _keys(self, pairs: Pairs) -> np.ndarray:
        features, shapes = self._radix
        numbers = (pairs.first * shapes + pairs.second) * features + pairs.own
        return self._first_key(pairs.feature) + numbers * features + pairs.other

    def _pairs_of(self, keys: np.ndarray) -> Pairs:
        """The pairs of keys of one kind of features."""
        features, shapes = self._radix
        rest, other = np.divmod(keys, features)
        rest, own = np.divmod(rest, features)
        rest, second = np.divmod(rest, shapes)
        kind, first = np.divmod(rest, shapes)
        return Pairs(Feature(int(kind[0])), first, second, own, other)


def _some(pairs: Pairs, selected: np.ndarray) -> Pairs:
    names = ("first", "second", "own", "other")
    return replace(pairs, **{name: getattr(pairs, name)[selected] for name in names})
