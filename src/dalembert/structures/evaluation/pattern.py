"""Where the matrices of a structure have entries, found once for all of them.

Matrices of one pattern share their index arrays, so that sums and parts of them are sums and parts
of their entries alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from functools import cached_property

import numpy as np
import scipy

from dalembert.structures.evaluation.block import ElementBlock


class Pattern:
    """Entries that any element has.

    Parameters
    ----------
    blocks : elements
    size : number of displacements
    """

    def __init__(self, blocks: Sequence[ElementBlock], size: int):
        self.blocks, self.size = blocks, size

    @cached_property
    def _places(self) -> tuple[scipy.sparse.csc_matrix, dict[ElementBlock, np.ndarray]]:
        """The matrix without numbers, and the entry that each entry of an element belongs to."""
        keys = [np.zeros(0, dtype=np.int64)]
        for block in self.blocks:
            rows, columns = block.degrees[:, None, :], block.degrees[None, :, :]
            keys.append((columns * np.int64(self.size) + rows).ravel())
        found, slots = np.unique(np.concatenate(keys), return_inverse=True)
        columns, rows = np.divmod(found, max(self.size, 1))
        starts = np.searchsorted(columns, np.arange(self.size + 1))
        ends = np.cumsum([key.size for key in keys])[:-1]
        each = np.split(slots.astype(np.int32), ends)[1:]
        empty = _matrix(rows, starts, self.size)
        return empty, dict(zip(self.blocks, each, strict=True))

    def slots(self, blocks: Sequence[ElementBlock]) -> np.ndarray:
        """Number of the entry that each entry of these elements belongs to, one after another."""
        each = self._places[1]
        return np.concatenate([np.zeros(0, dtype=np.int32), *(each[b] for b in blocks)])

    def matrix(self, entries: np.ndarray, slots: np.ndarray) -> scipy.sparse.csc_matrix:
        """The sum of what belongs to each entry."""
        empty = self._places[0]
        return filled(empty, np.bincount(slots, entries, minlength=empty.indices.size))

    def part(self, chosen: np.ndarray) -> tuple[np.ndarray, scipy.sparse.csc_matrix]:
        """Entries in chosen rows and columns, and the matrix of these without numbers."""
        empty = self._places[0]
        new = np.full(self.size, -1)
        new[chosen] = np.arange(chosen.size)
        columns = np.repeat(new, np.diff(empty.indptr))
        kept = np.flatnonzero((new[empty.indices] >= 0) & (columns >= 0))
        starts = np.searchsorted(columns[kept], np.arange(chosen.size + 1))
        return kept, _matrix(new[empty.indices[kept]], starts, chosen.size)

    def holds(self, matrix: scipy.sparse.spmatrix) -> bool:
        """Whether a matrix has been made by this pattern."""
        return getattr(matrix, "indices", None) is self._places[0].indices


def combined(*terms: tuple[float, scipy.sparse.csc_matrix]) -> scipy.sparse.csc_matrix:
    """``Σ factor · matrix``; matrices of one pattern are added entry by entry."""
    (factor, first), *others = terms
    if all(matrix.indices is first.indices for _, matrix in others):
        return filled(first, sum((f * m.data for f, m in others), factor * first.data))
    return sum((f * m for f, m in others), factor * first).tocsc()


def _matrix(rows: np.ndarray, starts: np.ndarray, size: int) -> scipy.sparse.csc_matrix:
    indices, starts = rows.astype(np.int32), starts.astype(np.int32)
    return scipy.sparse.csc_matrix((np.zeros(rows.size), indices, starts), shape=(size, size))


def filled(like: scipy.sparse.csc_matrix, entries: np.ndarray) -> scipy.sparse.csc_matrix:
    """Other entries at the same places."""
    made = copy(like)
    made.data = entries
    return made
