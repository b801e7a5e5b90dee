"""Gaps among rounded convex hulls and walls, with a numerical search for near features."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.corners_over_faces import leaving
from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps.gap_source import GapKind
from dalembert.analysis.nonsmooth.gaps.hulls.corners_over_hulls import (
    are_sharp,
    corners_over_hulls,
)
from dalembert.analysis.nonsmooth.gaps.hulls.feature_columns import FeatureColumns
from dalembert.analysis.nonsmooth.gaps.hulls.feature_pairs import Pairs, some_pairs
from dalembert.analysis.nonsmooth.gaps.hulls.hull_search import HullSearch
from dalembert.analysis.nonsmooth.gaps.positions import Positions
from dalembert.analysis.nonsmooth.gaps.searched_gaps import (
    EvaluatedGaps,
    LastPosition,
    SearchedGaps,
)
from dalembert.elements.contact.collisions import Collisions
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model


@dataclass(frozen=True, eq=False)
class ListedFeatures:
    """Features of a list of gaps.

    Attributes
    ----------
    keys : (n,) of the gaps
    parts : features of one kind each, and those of both bodies
    order : (n,) places of the gaps among the parts; None for one part
    first, second : (n,) numbers of the shapes
    """

    keys: np.ndarray
    parts: list[tuple[Feature, list[FeatureColumns]]]
    order: np.ndarray | None
    first: np.ndarray
    second: np.ndarray


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
        self.formulas = self.geometry.formulas
        self._search = HullSearch(self.geometry)
        self._first = np.cumsum([0, *self.geometry.feature_counts])
        self._last_listed: ListedFeatures | None = None

    def within(self, last: LastPosition) -> list[EvaluatedGaps]:
        near = self._search(last.at, last.reach, partial(self._normals, last.at))
        pairs = [part for part in map(self._with_ends, near) if part.first.size]
        if not pairs:
            return []
        gaps = EvaluatedGaps.joined([self._gaps(part, last.at) for part in pairs])
        return [gaps.some(gaps.distance <= last.reach)]

    def _with_ends(self, pairs: Pairs) -> Pairs:
        """The pairs without corners of endless shapes."""
        endless, feature = self.geometry.endless, pairs.feature
        if not endless.any() or feature is Feature.EDGES:
            return pairs
        corners = endless[pairs.second]
        if feature is Feature.CORNERS:
            corners = corners | endless[pairs.first]
        return some_pairs(pairs, ~corners)

    def selected(self, configuration: Configuration, keys: np.ndarray) -> Contacts:
        if not keys.size:
            return self.none()
        position, listed = self.position(configuration), self._listed(keys)
        gaps = [self._evaluated(*part, position.at)[:2] for part in listed.parts]
        distance, blocks = gaps[0]
        if listed.order is not None:
            distance, blocks = (np.concatenate(g)[listed.order] for g in zip(*gaps, strict=True))
        shapes = listed.first, listed.second
        return self.contacts(position, EvaluatedGaps(*shapes, distance, blocks, keys))

    def _listed(self, keys: np.ndarray) -> ListedFeatures:
        """Features of gaps with some keys; those of the last call if these are the same."""
        last = self._last_listed
        if last is None or not np.array_equal(keys, last.keys):
            kinds = keys // self._first[-1] ** 2
            rows = [np.flatnonzero(kinds == kind) for kind in np.unique(kinds)]
            pairs = [self._pairs_of(keys[own]) for own in rows]
            parts = [(part.feature, self.geometry.columns(part)) for part in pairs]
            order = np.argsort(np.concatenate(rows)) if len(rows) > 1 else None
            last = ListedFeatures(keys.copy(), parts, order, *self.shapes_of(keys))
            self._last_listed = last
        return last

    def shapes_of(self, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        numbers = np.stack(np.divmod(keys % self._first[-1] ** 2, self._first[-1]))
        first, second = np.searchsorted(self._first, numbers, side="right") - 1
        return first, second

    def separating(
        self, start: Configuration, end: Configuration, keys: np.ndarray, rounding: float
    ) -> np.ndarray:
        hulls = {(int(i), int(j)) for i, j in zip(*self.shapes_of(keys), strict=True)}
        pairs = [pair for i, j in hulls for pair in ((i, j), (j, i))]
        tables = [table for i, j in pairs if (table := self.geometry.face_gaps(i, j)).size]
        if not tables:
            return keys[:0]
        faces = Pairs(Feature.FACE, *np.hstack(tables))
        opened, closed = (self._evaluate(faces, self.position(at).at)[0] for at in (start, end))
        sides = np.stack([faces.first, faces.second, faces.own])
        face = np.unique(sides, axis=1, return_inverse=True)[1]
        lowest = np.full(face.max(initial=0) + 1, np.inf)
        np.minimum.at(lowest, face, opened)
        return self._keys(some_pairs(faces, (lowest[face] >= -rounding) & (closed < -rounding)))

    def leaving(self, start: Configuration, end: Configuration, keys: np.ndarray) -> np.ndarray:
        mask = np.zeros(keys.size, dtype=bool)
        rows = np.flatnonzero(keys // self._first[-1] ** 2 == Feature.FACE)
        pairs = self._pairs_of(keys[rows]) if rows.size else None
        if pairs is None:
            return mask
        places = [self.position(configuration).at for configuration in (start, end)]
        sharp = are_sharp(self.geometry, pairs, places[0])
        pairs, rows = some_pairs(pairs, sharp), rows[sharp]
        if rows.size:
            corners = (corners_over_hulls(self.geometry, pairs, at) for at in places)
            mask[rows] = leaving(*corners).any(axis=0)
        return mask

    def kinds(self, keys: np.ndarray) -> list[GapKind]:
        numbers, kinds = keys // self._first[-1] ** 2, []
        for number in np.unique(numbers):
            rows = np.flatnonzero(numbers == number)
            pairs = self._pairs_of(keys[rows])
            function, entries = self.function(pairs.feature), self.geometry.entries(pairs)
            kinds.append(self.kind(function, rows, entries, pairs.first, pairs.second))
        return kinds

    def points(
        self, configuration: Configuration, keys: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        at = self.geometry.positions(configuration)
        places = np.zeros((keys.size, 3))
        directions = np.zeros((keys.size, 3, self.dimension))
        kinds = keys // self._first[-1] ** 2
        for kind in np.unique(kinds):
            own = kinds == kind
            places[own], directions[own] = self._evaluate(self._pairs_of(keys[own]), at)[2:]
        return places, directions

    # gaps of pairs -------------------------------------------------------------------------------
    def _gaps(self, pairs: Pairs, at: Positions) -> EvaluatedGaps:
        """Gaps of pairs."""
        distance, blocks, *_ = self._evaluate(pairs, at)
        return EvaluatedGaps(pairs.first, pairs.second, distance, blocks, self._keys(pairs))

    def _evaluate(self, pairs: Pairs, at: Positions) -> list[np.ndarray]:
        return self._evaluated(pairs.feature, self.geometry.columns(pairs), at)

    def _evaluated(
        self, feature: Feature, sides: list[FeatureColumns], at: Positions
    ) -> list[np.ndarray]:
        return self.evaluate(feature, [columns(at) for columns in sides])

    def _normals(self, at: Positions, pairs: Pairs) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(n,) distances, (n, 3) places and (n, 3) normals."""
        gap, _, place, directions = self._evaluate(pairs, at)
        return gap, place, directions[:, :, 0]

    def _keys(self, pairs: Pairs) -> np.ndarray:
        own, other = self._first[pairs.first] + pairs.own, self._first[pairs.second] + pairs.other
        keys: np.ndarray = (int(pairs.feature) * self._first[-1] + own) * self._first[-1] + other
        return keys

    def _pairs_of(self, keys: np.ndarray) -> Pairs:
        """The pairs of keys of one kind of features."""
        rest, other = np.divmod(keys, self._first[-1])
        kind, own = np.divmod(rest, self._first[-1])
        first, second = (np.searchsorted(self._first, n, side="right") - 1 for n in (own, other))
        own, other = own - self._first[first], other - self._first[second]
        return Pairs(Feature(int(kind[0])), first, second, own, other)
