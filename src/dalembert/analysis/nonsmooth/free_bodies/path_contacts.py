"""Contacts of a step in machine code, and means of their directions over the path of the step."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from dalembert.analysis.nonsmooth.free_bodies.free_body_motion import FreeBodyMotion
from dalembert.integrators.contact.machine_code import Loop
from dalembert.integrators.contact.places import Counts
from dalembert.integrators.contact.step_calls import Calls, StepOutcome
from dalembert.integrators.contact.step_places import (
    Descriptions,
    Forms,
    Limits,
    ShapePlaces,
    Sizes,
)

SHAPES = [Descriptions.SHAPE, Descriptions.OTHER_SHAPE]
"""Columns of both shapes in a description."""


class PathContacts(ABC):
    """Contacts with keys and descriptions: kind, shape and feature of both sides, and the pair.

    A subclass allocates the arrays, among them those of the path: keys, descriptions, gaps, means
    of the directions and normals at its first position.
    """

    counts: np.ndarray
    body: np.ndarray
    limits: np.ndarray
    width: int
    _motion: FreeBodyMotion
    _loop: Loop | None
    _sizes: np.ndarray
    _keys: np.ndarray
    _described: np.ndarray
    _gaps: np.ndarray
    _path: tuple[np.ndarray, ...]
    _before: tuple[np.ndarray, np.ndarray]
    _shares_of_path: np.ndarray
    _speeds: tuple[np.ndarray, np.ndarray]

    @abstractmethod
    def __call__(self) -> StepOutcome:
        """A call of the machine code, in which arrays grow as needed."""

    @abstractmethod
    def _reserve(self, contacts: int) -> None:
        """Memory for a number of contacts."""

    def contacts(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Keys, descriptions and gaps of the contacts at the start of the last call."""
        count = self.counts[Counts.CONTACTS]
        return self._keys[:count].copy(), self._described[:count].copy(), self._gaps[:count].copy()

    def fastest(self) -> float:
        """The largest component of a relative velocity of the contacts [m/s]; rotations count as
        velocities."""
        rows = int(self.counts[Counts.CONTACTS]) * self.width
        return float(max(np.abs(speeds[:rows]).max(initial=0.0) for speeds in self._speeds))

    def contacts_before(self) -> tuple[np.ndarray, np.ndarray]:
        """Keys and descriptions of the contacts of the last completed step."""
        count = self._sizes[Sizes.BEFORE]
        return self._before[0][:count].copy(), self._before[1][:count].copy()

    def keys_of(self, described: np.ndarray) -> np.ndarray:
        """Keys of contacts between hulls, by their descriptions."""
        features = int(self._sizes[Sizes.FEATURES])
        first = self._motion.shapes.places[:, ShapePlaces.FEATURES]
        kind, i, own, j, other = described[:, : Descriptions.PAIR].T.astype(np.int64)
        keys = (kind * features + first[i] + own) * features + first[j] + other
        return np.asarray(self._sizes[Sizes.OFFSET] + keys)

    def face_contacts(self, first: int, second: int, pair: int) -> np.ndarray:
        """Descriptions of the contacts of each face of a hull and each corner of another one; none
        of walls."""
        shapes = self._motion.shapes
        if max(first, second) >= shapes.hulls:
            return np.zeros((0, Descriptions.size()), np.int32)
        starts = shapes.places[[first, second], ShapePlaces.FORM]
        form, other = (shapes.records[start:] for start in starts)
        count = form[Forms.EDGES if shapes.dimension == 2 else Forms.FACES]
        face, corner = np.indices((count, other[Forms.CORNERS])).reshape(2, -1)
        one = np.ones_like(face)
        columns = one, first * one, face, second * one, corner, pair * one
        return np.column_stack(columns).astype(np.int32)

    def renumber(self, pairs: np.ndarray) -> None:
        """Numbers of the pairs of the contacts before in another list; contacts of shapes that are
        no longer listed are removed."""
        count = self._sizes[Sizes.BEFORE]
        keys, described = (part[:count].copy() for part in self._before)
        listed = self.pair_numbers(pairs, described)
        self._sizes[Sizes.BEFORE] = left = int(listed.sum())
        self._before[0][:left], self._before[1][:left] = keys[listed], described[listed]

    def pair_numbers(self, pairs: np.ndarray, described: np.ndarray) -> np.ndarray:
        """(n,) mask of the contacts of listed pairs, whose numbers are changed to those of a list
        (2, m)."""
        shapes = np.array([self._motion.shapes.count, 1])
        codes: np.ndarray = shapes @ np.sort(pairs, axis=0)
        order, own = np.argsort(codes), np.sort(described[:, SHAPES], axis=1) @ shapes
        place = np.searchsorted(codes, own, sorter=order)
        listed = np.isin(own, codes)
        described[listed, Descriptions.PAIR] = order[place[listed]]
        return listed

    def set_path(self, keys: np.ndarray, described: np.ndarray) -> None:
        """Contacts of the path, with means that are zero."""
        self._sizes[Sizes.PATH] = count = keys.size
        if count > self._path[0].size:
            self._reserve(count)
        self._path[0][:count], self._path[1][:count] = keys, described
        self._forget_means()

    def _forget_means(self) -> None:
        """Zero means over the path, and no normals of its first position."""
        for values in self._path[3:]:
            values[:] = 0.0

    def path_gaps(self, weight: float = 0.0, shares: np.ndarray | None = None) -> np.ndarray:
        """Gaps of the contacts of the path where the shapes are; with a weight in the means, whose
        tangents are those of the first position."""
        assert self._loop is not None
        self.limits[Limits.PATH_WEIGHT], self._sizes[Sizes.CALL] = weight, Calls.ON_PATH
        if shares is not None:
            self._shares_of_path[:] = shares
        self._loop()
        self._sizes[Sizes.CALL] = Calls.STEP
        return self._path[2][: self._sizes[Sizes.PATH]].copy()

    def forced(self) -> float:
        """The largest change of a normal speed by the forces in the arrays, of the contacts of the
        path where the shapes are and of those within reach [m/s]; infinite if the call failed."""
        self._forget_means()
        self.path_gaps(1.0, np.ones(self._shares_of_path.size))
        self._sizes[Sizes.CALL] = Calls.ALL
        done = self() is StepOutcome.DONE
        self._sizes[Sizes.CALL] = Calls.STEP
        rows = slice(0, int(self.counts[Counts.CONTACTS]) * self.width, self.width)
        before, free = (speeds[rows] for speeds in self._speeds)
        return float(np.abs(free - before).max(initial=0.0)) if done else np.inf

    def shift_path_gaps(self, gaps: np.ndarray, displacement: np.ndarray) -> None:
        """Distances at the start by which gaps at the end are linear in the displacement."""
        first, body, widest = self._motion.first, self.body, 2 * self._motion.widest
        means = self._path[3].reshape(-1, self.width, widest)[:, 0]
        for k, gap in enumerate(gaps):
            bodies = [b for b in body[self._path[1][k, SHAPES]] if b >= 0]
            own = np.concatenate([np.arange(first[b], first[b + 1]) for b in bodies])
            self._path[2][k] = gap - means[k, : own.size] @ displacement[own]

    @property
    def on_path(self) -> bool:
        """Whether contacts have means over a path."""
        return bool(self._sizes[Sizes.PATH])

    def leave_path(self) -> None:
        """No means over a path in the following steps."""
        self._sizes[Sizes.PATH] = 0
