"""Gaps among rounded convex hulls and walls, with a numerical search for near features."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.feature_pairs import Pairs, some_pairs
from dalembert.analysis.nonsmooth.gap_functions import Feature, gap_function
from dalembert.analysis.nonsmooth.gaps import GapKind, GapSource, Instant
from dalembert.analysis.nonsmooth.hull_geometry import HullGeometry, Positions
from dalembert.analysis.nonsmooth.hull_search import HullSearch
from dalembert.analysis.nonsmooth.shape_velocities import TWIST
from dalembert.elements.contact.collisions import Collisions
from dalembert.integrators.contact.contact_laws import FIRST, ContactLaws
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel

SMALLEST = 16
"""Number of columns of the smallest mapped function; larger ones have 2, 4, 8 … times as many."""


@dataclass(eq=False)
class LastPosition:
    """Gaps at one position, which a step evaluates several times.

    Attributes
    ----------
    time, y, p : position and parameters
    at, velocities : positions and velocities of the shapes
    reach : distance within which gaps are evaluated; at first that of the position before
    requested : largest distance of a request
    contacts : the gaps; None before the first request
    """

    time: float
    y: np.ndarray
    p: np.ndarray
    at: Positions
    velocities: np.ndarray
    reach: float
    requested: float = 0.0
    contacts: Contacts | None = None

    def is_at(self, time: float, y: np.ndarray, p: np.ndarray) -> bool:
        """Whether this is the position."""
        return time == self.time and np.array_equal(y, self.y) and np.array_equal(p, self.p)


class HullGaps(GapSource):
    """Gaps of one ``Collisions`` element, except those of balls with balls and walls.

    A numerical search selects features of near hulls; the gap of two features is a smooth function.

    Parameters
    ----------
    model : Model
    element : Collisions
    """

    def __init__(self, model: Model, element: Collisions):
        self.elements, self.groups = [element], element.friction_groups
        self.dimension: int = element.dimension
        self.law = element.law
        self.geometry = geometry = HullGeometry(model, element)
        self.formulas = geometry.formulas
        self._groups, self._laws = element.group_of(geometry.shapes), element.laws
        self._search = HullSearch(geometry, self._groups, self._laws)
        self._first = np.cumsum([0, *geometry.feature_counts])
        self._speeds = model.all_equations.speed_count
        self._last: LastPosition | None = None
        self._kernels: dict[tuple[Feature, int], Kernel] = {}

    def near(
        self,
        time: float,
        y: np.ndarray,
        p: np.ndarray,
        travels: np.ndarray,
        groups: tuple[int, ...],
    ) -> Contacts:
        last = self._last = self._position(time, y, p)
        reach = self._reach(last.at, last.velocities, travels)
        if last.contacts is None or reach > last.reach or last.contacts.groups != groups:
            last.reach = max(last.reach, reach)
            parts = [
                self._contacts(pairs, last, last.reach, groups)
                for pairs in self._search(last.at, last.reach, partial(self._normals, last.at))
            ]
            last.contacts = Contacts.joined(parts or [self._none(groups)])
        last.requested = max(last.requested, reach)
        return last.contacts.some(last.contacts.distance <= reach)

    def selected(
        self,
        time: float,
        y: np.ndarray,
        p: np.ndarray,
        keys: np.ndarray,
        groups: tuple[int, ...],
    ) -> Contacts:
        position, kinds = self._position(time, y, p), keys // self._first[-1] ** 2
        rows = [np.flatnonzero(kinds == kind) for kind in np.unique(kinds)]
        parts = [
            self._contacts(self._pairs_of(keys[own]), position, np.inf, groups) for own in rows
        ]
        order = np.argsort(np.concatenate([np.zeros(0, dtype=int), *rows]))
        return Contacts.joined(parts or [self._none(groups)]).some(order)

    def _position(self, time: float, y: np.ndarray, p: np.ndarray) -> LastPosition:
        """The last position if it is this one, else a new one."""
        last = self._last
        if last is not None and last.is_at(time, y, p):
            return last
        geometry = self.geometry
        at, velocities = geometry.positions(time, y, p), geometry.velocities(time, y, p)
        ahead = 0.0 if last is None else last.requested
        return LastPosition(time, y.copy(), p.copy(), at, velocities, ahead)

    def separating(
        self, start: Instant, end: Instant, p: np.ndarray, keys: np.ndarray, rounding: float
    ) -> np.ndarray:
        numbers = np.stack(np.divmod(keys % self._first[-1] ** 2, self._first[-1]))
        shapes = np.searchsorted(self._first, numbers, side="right") - 1
        hulls = {(int(i), int(j)) for i, j in shapes.T}
        pairs = [pair for i, j in hulls for pair in ((i, j), (j, i))]
        tables = [table for i, j in pairs if (table := self.geometry.face_gaps(i, j)).size]
        if not tables:
            return keys[:0]
        faces = Pairs(Feature.FACE, *np.hstack(tables))
        opened, closed = (
            self._evaluate(faces, self._position(*instant, p).at)[0] for instant in (start, end)
        )
        sides = np.stack([faces.first, faces.second, faces.own])
        face = np.unique(sides, axis=1, return_inverse=True)[1]
        lowest = np.full(face.max(initial=0) + 1, np.inf)
        np.minimum.at(lowest, face, opened)
        return self._keys(some_pairs(faces, (lowest[face] >= -rounding) & (closed < -rounding)))

    def kinds(self, keys: np.ndarray) -> list[GapKind]:
        numbers, kinds = keys // self._first[-1] ** 2, []
        for number in np.unique(numbers):
            rows = np.flatnonzero(numbers == number)
            pairs = self._pairs_of(keys[rows])
            shapes = np.stack([pairs.first, pairs.second], 1)[..., None]
            velocities = (TWIST * shapes + np.arange(TWIST)).reshape(rows.size, -1)
            laws = self.geometry.law_entries(self._law(pairs), FIRST + len(self.groups))
            function, entries = self._function(pairs.feature), self.geometry.entries
            kinds.append(GapKind(function, rows, entries(pairs), velocities, laws))
        return kinds

    def points(
        self, time: float, y: np.ndarray, p: np.ndarray, keys: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        at = self.geometry.positions(time, y, p)
        places = np.zeros((keys.size, 3))
        directions = np.zeros((keys.size, 3, self.dimension))
        kinds = keys // self._first[-1] ** 2
        for kind in np.unique(kinds):
            own = kinds == kind
            places[own], directions[own] = self._evaluate(self._pairs_of(keys[own]), at)[2:]
        return places, directions

    def _reach(self, at: Positions, velocities: np.ndarray, travels: np.ndarray) -> float:
        """Largest distance that two shapes cover by displacements of their twists."""
        moved = self.geometry.velocities.displacements(velocities, travels)
        hulls, starts = len(self.geometry.hulls), self.geometry.starts
        arms = at.corners - np.repeat(at.origins[:hulls], np.diff(starts), axis=0)
        arm = np.zeros(at.radii.size)
        arm[:hulls] = np.maximum.reduceat(np.linalg.norm(arms, axis=1), starts[:-1])
        straight, turned = (np.linalg.norm(moved[:, s], axis=1) for s in (slice(3), slice(3, 6)))
        return 2 * float((straight + arm[:, None] * turned).max(initial=0.0))

    # gaps of pairs -------------------------------------------------------------------------------
    def _contacts(
        self, pairs: Pairs, last: LastPosition, reach: float, groups: tuple[int, ...]
    ) -> Contacts:
        """Gaps of pairs within reach."""
        distance, blocks, *_ = self._evaluate(pairs, last.at)
        near = distance <= reach
        pairs, count = some_pairs(pairs, near), int(near.sum())
        laws, width = last.at.coefficients[:, self._law(pairs)], 1 + sum(groups)
        directions = self.geometry.velocities.gap_derivatives(
            blocks[near], pairs.first, pairs.second, last.velocities
        )
        return Contacts(
            distance[near],
            directions.rows(np.arange(count), width),
            np.zeros((count, width)),
            ContactLaws.of(laws, groups),
            groups,
            self._keys(pairs),
            np.zeros(count, dtype=int),
        )

    def _evaluate(self, pairs: Pairs, at: Positions) -> list[np.ndarray]:
        """(n,) distances, (n, k, 12) derivatives of gap velocities by twists, (n, 3) places and
        (n, 3, k) directions."""
        count, k = pairs.first.size, self.dimension
        size = SMALLEST << max(0, int(np.ceil(np.log2(count / SMALLEST))))
        padded = np.arange(size) % count
        kernel = self._kernel(pairs.feature, size)
        distance, blocks, place, directions = kernel(
            *(column[:, padded] for column in self.geometry.columns(pairs, at))
        )
        return [
            distance.ravel()[:count],
            blocks.T.reshape(size, 2 * TWIST, -1)[:count].swapaxes(1, 2),
            place.T[:count],
            directions.T.reshape(size, k, 3)[:count].swapaxes(1, 2),
        ]

    def _normals(self, at: Positions, pairs: Pairs) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(n,) distances, (n, 3) places and (n, 3) normals."""
        gap, _, place, directions = self._evaluate(pairs, at)
        return gap, place, directions[:, :, 0]

    def _kernel(self, feature: Feature, size: int) -> Kernel:
        """Gap function mapped over ``size`` pairs."""
        if (feature, size) not in self._kernels:
            function = self._function(feature)
            self._kernels[feature, size] = Kernel(function.map(size))
        return self._kernels[feature, size]

    @property
    def _turns(self) -> bool:
        """Whether there is friction of rotations."""
        return len(self.groups) > 1

    def _function(self, feature: Feature) -> ca.Function:
        return gap_function(feature, self.dimension, self._turns)

    def _law(self, pairs: Pairs) -> np.ndarray:
        return self._laws[self._groups[pairs.first], self._groups[pairs.second]]

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

    def _none(self, groups: tuple[int, ...]) -> Contacts:
        empty, numbers = np.zeros(0), np.zeros(0, dtype=int)
        rows = np.zeros((0, self._speeds)), np.zeros((0, 1 + sum(groups)))
        laws = ContactLaws.of(np.zeros((FIRST + len(groups), 0)), groups)
        return Contacts(empty, *rows, laws, groups, numbers, numbers)
