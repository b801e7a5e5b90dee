"""Gaps of boundaries that may be concave with all other shapes."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.boundaries import Boundaries, PlacedBoundaries
from dalembert.analysis.nonsmooth.boundary_formulas import BoundaryFormulas
from dalembert.analysis.nonsmooth.boundary_search import BoundarySearch, Feet, Touch
from dalembert.analysis.nonsmooth.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps import SymbolicGap
from dalembert.analysis.nonsmooth.hull_geometry import Positions
from dalembert.analysis.nonsmooth.searched_gaps import LastPosition, SearchedGaps
from dalembert.elements.contact.collisions import Collisions
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model


class BoundaryGaps(SearchedGaps):
    """Gaps of smooth curves and of polygons with dents in one ``Collisions`` element.

    At a contact point the gap is that of a straight surface and a ball, or a point: both are at the
    nearest points of the shapes, so that first derivatives are exact.

    Parameters
    ----------
    model : Model
    element : Collisions
    """

    def __init__(self, model: Model, element: Collisions):
        super().__init__(model, element)
        geometry = self.geometry
        self._boundaries = Boundaries(model, geometry.boundaries)
        features = max(
            self._boundaries.features, *(len(hull.corners) for hull in geometry.hulls), 1
        )
        self._radix = features, len(geometry.shapes)
        self._placed: tuple[Positions, PlacedBoundaries] | None = None

    def within(self, last: LastPosition, groups: tuple[int, ...]) -> list[Contacts]:
        parts = []
        search = BoundarySearch(self.geometry, self._at(last.at, last.p), last.at, last.reach)
        for feet in search.feet():
            if feet.first.size:
                gaps = self.evaluate(Feature.WALL, self._columns(feet, last.at))
                near = gaps[0] <= last.reach
                feet, gaps = feet.some(near), [part[near] for part in gaps]
                key = self._keys(feet)
                parts.append(self.contacts(last, feet.first, feet.second, gaps, key, groups))
        return parts

    def arms(self, at: Positions) -> np.ndarray:
        arms = super().arms(at)
        if self._last is not None:
            placed = self._at(at, self._last.p)
            arms[placed.first_shape :] = placed.arms
        return arms

    def symbolic(self, key: int) -> SymbolicGap:
        features, shapes = self._radix
        rest, other = divmod(int(key), features)
        rest, own = divmod(rest, features)
        rest, second = divmod(rest, shapes)
        kind, first = divmod(rest, shapes)
        formulas = BoundaryFormulas(self.geometry, self._boundaries)
        columns = formulas.columns(Touch(kind), first, second, own, other)
        return self.formula(Feature.WALL, columns, first, second)

    def points(
        self, time: float, y: np.ndarray, p: np.ndarray, keys: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        places, directions = super().points(time, y, p, keys)
        at = self.geometry.positions(time, y, p)
        placed = self._at(at, p)
        reach = 0.0 if self._last is None else self._last.requested
        reach = max(reach, 0.1 * float(placed.balls[1].max(initial=0.0)))
        for feet in BoundarySearch(self.geometry, placed, at, reach).feet():
            own = self._keys(feet)
            order = np.argsort(own)
            place = np.searchsorted(own, keys, sorter=order)
            row = order[np.minimum(place, max(own.size - 1, 0))] if own.size else place
            same = own[row] == keys if own.size else np.zeros(keys.size, dtype=bool)
            if same.any():
                gaps = self.evaluate(Feature.WALL, self._columns(feet.some(row[same]), at))
                places[same], directions[same] = gaps[2:]
        return places, directions

    def _at(self, at: Positions, p: np.ndarray) -> PlacedBoundaries:
        """Boundaries at the last position."""
        if self._placed is None or self._placed[0] is not at:
            self._placed = at, PlacedBoundaries(self._boundaries, self.geometry, at, p)
        return self._placed[1]

    def _columns(self, feet: Feet, at: Positions) -> list[np.ndarray]:
        """Arguments of the gap function of a wall and a ball."""
        count = feet.first.size
        rest = np.zeros((1, count))
        radii = at.radii[feet.second] if feet.kind in (Touch.CORNER, Touch.SIDE) else rest[0]
        surface = [feet.surface.T, rest, feet.normal.T, rest, rest, at.origins[feet.first].T]
        ball = [feet.place.T, rest, radii[None], at.origins[feet.second].T]
        return [np.vstack(surface), np.vstack(ball)]

    def _keys(self, feet: Feet) -> np.ndarray:
        features, shapes = self._radix
        numbers = (int(feet.kind) * shapes + feet.first) * shapes + feet.second
        keys: np.ndarray = (numbers * features + feet.own) * features + feet.other
        return keys
