"""Sparsity pattern of the matrices of a structure.

Matrices of one pattern share their index arrays, so that sums and submatrices are sums and
selections of their entries.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from functools import cached_property

import numpy as np
import scipy

from dalembert.model.assembled.evaluation.block import ElementBlock


class Pattern:
    """Pattern of the sum of element matrices.

    Parameters
    ----------
    blocks : elements
    size : number of displacements
    """

    def __init__(self, blocks: Sequence[ElementBlock], size: int):
        self.blocks, self.size = blocks, size

    @cached_property
    def _structure(self) -> tuple[scipy.sparse.csc_matrix, dict[ElementBlock, np.ndarray]]:
        """The matrix with zero entries, and the entry to which each element entry belongs."""
        keys = [np.zeros(0, dtype=np.int64)]
        for block in self.blocks:
            rows, columns = block.degrees[:, None, :], block.degrees[None, :, :]
            keys.append((columns * np.int64(self.size) + rows).ravel())
        unique, slots = np.unique(np.concatenate(keys), return_inverse=True)
        columns, rows = np.divmod(unique, max(self.size, 1))
        starts = np.searchsorted(columns, np.arange(self.size + 1))
        ends = np.cumsum([key.size for key in keys])[:-1]
        slots_of_blocks = np.split(slots.astype(np.int32), ends)[1:]
        empty = _matrix(rows, starts, self.size)
        return empty, dict(zip(self.blocks, slots_of_blocks, strict=True))

    def slots(self, blocks: Sequence[ElementBlock]) -> np.ndarray:
        """Index of the entry to which each entry of the elements belongs, block by block."""
        slots_of_blocks = self._structure[1]
        return np.concatenate([np.zeros(0, dtype=np.int32), *(slots_of_blocks[b] for b in blocks)])

    def matrix(self, entries: np.ndarray, slots: np.ndarray) -> scipy.sparse.csc_matrix:
        """The matrix with element entries summed by slot."""
        empty = self._structure[0]
        return with_entries(empty, np.bincount(slots, entries, minlength=empty.indices.size))

    def part(self, selected: np.ndarray) -> tuple[np.ndarray, scipy.sparse.csc_matrix]:
        """Indices of the entries in selected rows and columns, and the submatrix with zeros."""
        empty = self._structure[0]
        new = np.full(self.size, -1)
        new[selected] = np.arange(selected.size)
        columns = np.repeat(new, np.diff(empty.indptr))
        entries = np.flatnonzero((new[empty.indices] >= 0) & (columns >= 0))
        starts = np.searchsorted(columns[entries], np.arange(selected.size + 1))
        return entries, _matrix(new[empty.indices[entries]], starts, selected.size)

    def matches(self, matrix: scipy.sparse.spmatrix) -> bool:
        """Whether a matrix has this pattern."""
        return getattr(matrix, "indices", None) is self._structure[0].indices


def combine(*terms: tuple[float, scipy.sparse.csc_matrix]) -> scipy.sparse.csc_matrix:
    """``Σ factor · matrix``; matrices of one pattern are added entry by entry."""
    (factor, first), *more = terms
    if all(matrix.indices is first.indices for _, matrix in more):
        return with_entries(first, sum((f * m.data for f, m in more), factor * first.data))
    return sum((f * m for f, m in more), factor * first).tocsc()


def _matrix(rows: np.ndarray, starts: np.ndarray, size: int) -> scipy.sparse.csc_matrix:
    indices, starts = rows.astype(np.int32), starts.astype(np.int32)
    return scipy.sparse.csc_matrix((np.zeros(rows.size), indices, starts), shape=(size, size))


def with_entries(like: scipy.sparse.csc_matrix, entries: np.ndarray) -> scipy.sparse.csc_matrix:
    """A matrix of the same pattern with other entries."""
    matrix = copy(like)
    matrix.data = entries
    return matrix
