"""Gaps of boundaries that may be concave with all other shapes."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.boundaries.boundaries import Boundaries, PlacedBoundaries
from dalembert.analysis.nonsmooth.gaps.boundaries.boundary_formulas import Arc, touch_function
from dalembert.analysis.nonsmooth.gaps.boundaries.boundary_search import BoundarySearch, Feet, Touch
from dalembert.analysis.nonsmooth.gaps.boundaries.leaving_corners import (
    FollowingContacts,
    corners_over_sides,
)
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.corners_over_faces import leaving
from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps.gap_source import GapFormulas, GapKind
from dalembert.analysis.nonsmooth.gaps.hulls.outline_corners import OutlineCorners
from dalembert.analysis.nonsmooth.gaps.positions import Positions
from dalembert.analysis.nonsmooth.gaps.searched_gaps import (
    EvaluatedGaps,
    LastPosition,
    SearchedGaps,
)
from dalembert.analysis.nonsmooth.gaps.shape_velocities import TWIST
from dalembert.elements.contact.collisions import Collisions
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.evaluation.mapped_kernel import MappedKernel


class BoundaryGaps(SearchedGaps):
    """Gaps of smooth curves and of polygons with dents in one ``Collisions`` element.

    At a contact point the gap is that of a straight surface and a ball, or a point: both are at the
    nearest points of the shapes, so that first derivatives are exact.

    Parameters
    ----------
    model : Model
    element : Collisions

    Attributes
    ----------
    boundaries : those of all shapes
    """

    def __init__(self, model: Model, element: Collisions):
        super().__init__(model, element)
        geometry = self.geometry
        self.boundaries = Boundaries(model, geometry.boundaries)
        self._corners = OutlineCorners(geometry)
        self._following = FollowingContacts(geometry)
        features = max(self.boundaries.features, *(len(hull.corners) for hull in geometry.hulls), 1)
        self._radix = features, len(geometry.shapes)
        self._first_shape = len(geometry.shapes) - len(geometry.boundaries)
        curve_of = self.boundaries.curve_of
        self._curve_of = np.concatenate([np.full(self._first_shape, -1), curve_of])
        shapes, p, vertices = geometry.formulas, model.all_equations.p, self.boundaries.vertices
        self._vertices = shapes.geometry.numel()
        self._parameters = self._vertices + vertices.numel()
        self.formulas = GapFormulas(
            ca.vertcat(shapes.geometry, ca.vec(vertices), p), shapes.velocities
        )
        e = model.all_equations
        self._values = Kernel(ca.Function("values", [e.t, e.y, e.p], [self.formulas.geometry]))
        self._functions: dict[tuple[int, ...], ca.Function] = {}
        self._mapped: dict[ca.Function, MappedKernel] = {}
        self._last_listed: tuple[np.ndarray, list[GapKind], tuple[np.ndarray, np.ndarray]] | None
        self._last_listed = None
        self._placed: tuple[Positions, PlacedBoundaries] | None = None

    def within(self, last: LastPosition) -> list[EvaluatedGaps]:
        parts = []
        search = BoundarySearch(
            self.geometry,
            self._corners,
            self._at(last.at, last.configuration.p),
            last.at,
            last.reach,
        )
        for feet in search.feet():
            if feet.first.size:
                gaps = self.evaluate(Feature.WALL, self._columns(feet, last.at))
                columns = feet.first, feet.second, *gaps[:2], self._keys(feet)
                parts.append(EvaluatedGaps(*columns).some(gaps[0] <= last.reach))
        return parts

    def arms(self, at: Positions) -> np.ndarray:
        arms = super().arms(at)
        if self._recent.last is not None:
            placed = self._at(at, self._recent.last.configuration.p)
            arms[placed.first_shape :] = placed.arms
        return arms

    def selected(self, configuration: Configuration, keys: np.ndarray) -> Contacts:
        if not keys.size:
            return self.none()
        values = self._values(*configuration)[0].ravel()
        if self._last_listed is None or not np.array_equal(keys, self._last_listed[0]):
            self._last_listed = keys.copy(), self.kinds(keys), self.shapes_of(keys)
        kinds, shapes = self._last_listed[1:]
        distance = np.zeros(keys.size)
        blocks = np.zeros((keys.size, 1 + sum(self.groups), 2 * TWIST))
        for kind in kinds:
            if kind.function not in self._mapped:
                self._mapped[kind.function] = MappedKernel(kind.function)
            columns = (values[entries].T for entries in kind.arguments)
            distances, derivatives, *_ = self._mapped[kind.function](*columns)
            distance[kind.row], blocks[kind.row] = distances.ravel(), derivatives
        gaps = EvaluatedGaps(*shapes, distance, blocks, keys)
        return self.contacts(self.position(configuration), gaps)

    def leaving(self, start: Configuration, end: Configuration, keys: np.ndarray) -> np.ndarray:
        touch, first, second, own, other = self._parts(keys)
        mask, rows = np.zeros(keys.size, dtype=bool), np.flatnonzero(touch == Touch.SIDE)
        if rows.size:
            sides, corners = (first[rows], own[rows]), (second[rows], other[rows])
            both = []
            for configuration in (start, end):
                at = self.geometry.positions(configuration)
                placed = PlacedBoundaries(self.boundaries, self.geometry, at, configuration.p)
                both.append(corners_over_sides(self.geometry, placed, at, sides, corners))
            followed = self._following.available(sides, second[rows])
            mask[rows] = (leaving(*both) & followed).any(axis=0)
        return mask

    def shapes_of(self, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        _, first, second, *_ = self._parts(keys)
        return first, second

    def kinds(self, keys: np.ndarray) -> list[GapKind]:
        touch, *columns = self._parts(keys)
        curves = [self._curve_of[shapes] for shapes in columns[:2]]
        arcs = [np.where(c >= 0, part, -1) for c, part in zip(curves, columns[2:], strict=True)]
        labels, number = np.unique(
            np.column_stack([touch, *curves, *arcs]), axis=0, return_inverse=True
        )
        kinds = []
        for k, label in enumerate(labels):
            rows = np.flatnonzero(number.ravel() == k)
            parts = tuple(int(n) for n in label)
            first, second, own, other = (column[rows] for column in columns)
            entries = [
                self._first_entries(Touch(parts[0]), first, own),
                self._second_entries(second, other),
            ]
            kinds.append(self.kind(self._touch_function(*parts), rows, entries, first, second))
        return kinds

    def points(
        self, configuration: Configuration, keys: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        places, directions = super().points(configuration, keys)
        at = self.geometry.positions(configuration)
        placed = self._at(at, configuration.p)
        reach = 0.0 if self._recent.last is None else self._recent.last.requested
        reach = max(reach, 0.1 * float(placed.balls[1].max(initial=0.0)))
        for feet in BoundarySearch(self.geometry, self._corners, placed, at, reach).feet():
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
            self._placed = at, PlacedBoundaries(self.boundaries, self.geometry, at, p)
        return self._placed[1]

    def _columns(self, feet: Feet, at: Positions) -> list[list[np.ndarray]]:
        """Arguments of the gap function of a wall and a ball."""
        count = feet.first.size
        rest = np.zeros((1, count))
        radii = at.radii[feet.second] if feet.kind in (Touch.CORNER, Touch.SIDE) else rest[0]
        surface = [feet.surface.T, rest, feet.normal.T, rest, rest, at.origins[feet.first].T]
        ball = [feet.place.T, rest, radii[None], at.origins[feet.second].T]
        return [surface, ball]

    def _keys(self, feet: Feet) -> np.ndarray:
        features, shapes = self._radix
        numbers = (int(feet.kind) * shapes + feet.first) * shapes + feet.second
        keys: np.ndarray = (numbers * features + feet.own) * features + feet.other
        return keys

    def _parts(self, keys: np.ndarray) -> list[np.ndarray]:
        """Kinds, both shapes and their parts."""
        features, shapes = self._radix
        rest, other = np.divmod(keys, features)
        rest, own = np.divmod(rest, features)
        rest, second = np.divmod(rest, shapes)
        kind, first = np.divmod(rest, shapes)
        return [kind, first, second, own, other]

    # entries of the formulas ---------------------------------------------------------------------
    def _touch_function(
        self, kind: int, curve: int, another: int, own: int, other: int
    ) -> ca.Function:
        """The gap function of two parts; curves and arcs are -1 for lines and corners."""
        key = kind, curve, another, own, other
        if key not in self._functions:
            curves = self.boundaries.curves
            first = Arc(curves[curve], own) if curve >= 0 else None
            second = Arc(curves[another], other) if another >= 0 else None
            self._functions[key] = touch_function(Touch(kind), first, second, self._turns)
        return self._functions[key]

    def _first_entries(self, kind: Touch, shape: np.ndarray, own: np.ndarray) -> np.ndarray:
        """Numbers of an arc or a straight line, for each gap."""
        numbers, geometry = self.geometry.numbers, self.geometry
        if kind in (Touch.CORNER, Touch.ARCS):
            return self._arc_entries(shape)
        if kind is Touch.WALL:
            return np.hstack([numbers.walls(shape), numbers.origins(shape)])
        following = np.stack([own, own + 1], axis=1)
        if kind is Touch.EDGE:
            start = geometry.starts[shape][:, None]
            corners = start + following % (geometry.starts[shape + 1][:, None] - start)
            parts = numbers.corners(corners), numbers.radii(shape), numbers.origins(shape)
            return np.hstack(parts)
        b, boundaries = shape - self._first_shape, self.boundaries
        vertices = boundaries.starts[b][:, None] + following % boundaries.counts[b][:, None]
        places = self._vertices + 2 * vertices[..., None] + np.arange(2)
        return np.hstack([self._frame_entries(shape), places.reshape(-1, 4)])

    def _second_entries(self, shape: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Numbers of an arc or a corner, for each gap."""
        if self._curve_of[shape[0]] >= 0:
            return self._arc_entries(shape)
        numbers, corners = self.geometry.numbers, self.geometry.starts[shape] + other
        parts = numbers.corners(corners[:, None]), numbers.radii(shape), numbers.origins(shape)
        return np.hstack(parts)

    def _arc_entries(self, shape: np.ndarray) -> np.ndarray:
        """Numbers of arcs of one curve."""
        parameters = self.boundaries.curves[self._curve_of[shape[0]]].parameters
        of_curve = np.tile(self._parameters + parameters, (shape.size, 1))
        return np.hstack([self._frame_entries(shape), of_curve])

    def _frame_entries(self, shape: np.ndarray) -> np.ndarray:
        numbers = self.geometry.numbers
        return np.hstack([numbers.origins(shape), numbers.axes(shape - self._first_shape)])
