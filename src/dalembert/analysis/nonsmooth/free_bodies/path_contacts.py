"""Contacts of a step in machine code, and means of their directions over the path of the step."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.free_bodies.free_body_motion import FreeBodyMotion
from dalembert.integrators.contact.machine_code import Loop

ONLY_PATH, PATH, BEFORE, SIZES = range(6, 10)
"""Places among the sizes of the shapes: whether only contacts of the path are evaluated, and the
numbers of these and of the contacts before; number of all sizes."""
COUNT = 0
"""Place of the number of contacts among the counts of the loop."""


class PathContacts:
    """Contacts with keys and descriptions: kind, shape and feature of both sides, and the pair.

    A subclass allocates the arrays.
    """

    counts: np.ndarray
    limits: np.ndarray
    width: int
    _motion: FreeBodyMotion
    _loop: Loop | None
    _sizes: np.ndarray
    _keys: np.ndarray
    _described: np.ndarray
    _gaps: np.ndarray
    _path: tuple[np.ndarray, np.ndarray, np.ndarray]
    _before: tuple[np.ndarray, np.ndarray]
    _means: np.ndarray
    _shares_of_path: np.ndarray

    def contacts(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Keys, descriptions and gaps of the contacts at the start of the last call."""
        count = self.counts[COUNT]
        return self._keys[:count].copy(), self._described[:count].copy(), self._gaps[:count].copy()

    def contacts_before(self) -> tuple[np.ndarray, np.ndarray]:
        """Keys and descriptions of the contacts of the last completed step."""
        count = self._sizes[BEFORE]
        return self._before[0][:count].copy(), self._before[1][:count].copy()

    def set_path(self, keys: np.ndarray, described: np.ndarray) -> None:
        """Contacts of the path, with means that are zero."""
        self._sizes[PATH] = count = keys.size
        self._path[0][:count], self._path[1][:count] = keys, described
        self._means[:] = 0.0

    def path_gaps(self, weight: float = 0.0, shares: np.ndarray | None = None) -> np.ndarray:
        """Gaps of the contacts of the path where the shapes are; with a weight in the means."""
        assert self._loop is not None
        self.limits[4], self._sizes[ONLY_PATH] = weight, 1
        if shares is not None:
            self._shares_of_path[:] = shares
        self._loop()
        self._sizes[ONLY_PATH] = 0
        return self._path[2][: self._sizes[PATH]].copy()

    def shift_path_gaps(self, gaps: np.ndarray, displacement: np.ndarray) -> None:
        """Distances at the start by which gaps at the end are linear in the displacement."""
        first, body, widest = self._motion.first, self._motion.body, 2 * self._motion.widest
        means = self._means.reshape(-1, self.width, widest)[:, 0]
        for k, gap in enumerate(gaps):
            bodies = [b for b in body[self._path[1][k, [1, 3]]] if b >= 0]
            own = np.concatenate([np.arange(first[b], first[b + 1]) for b in bodies])
            self._path[2][k] = gap - means[k, : own.size] @ displacement[own]

    def leave_path(self) -> None:
        """No means over a path in the following steps."""
        self._sizes[PATH] = 0


def contact_arrays(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Keys, descriptions and gaps of contacts."""
    return np.zeros(count, np.int64), np.zeros((count, 6), np.int32), np.zeros(count)
