"""Saddle-point matrices of coupled speeds and joints, assembled by stored places of entries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from dalembert.symbolic.evaluation.kernel import Matrix

Entries = tuple[np.ndarray, np.ndarray]
"""Rows and columns of the entries of a matrix that may differ from zero."""


def saddle(matrix: Matrix, joints: Matrix) -> Matrix:
    """``[[A, Cᵀ], [C, 0]]``."""
    m, n = joints.shape
    if scipy.sparse.issparse(matrix) or scipy.sparse.issparse(joints):
        blocks = [[matrix, joints.T], [joints, None]] if m else [[matrix]]
        return scipy.sparse.block_array(blocks, format="csc")
    whole = np.zeros((n + m, n + m))
    whole[:n, :n], whole[n:, :n], whole[:n, n:] = matrix, joints, joints.T
    return whole


@dataclass(frozen=True, eq=False)
class SaddlePattern:
    """Places of the entries of ``A`` and ``C`` in ``[[A, Cᵀ], [C, 0]]`` of some speeds.

    Attributes
    ----------
    parts : entries of ``A`` and ``C`` as they are stored
    source : entry of ``A`` or, after these, of ``C`` for each entry of the result
    indices, starts, size : pattern of the result, compressed by columns
    """

    parts: tuple[Entries, Entries]
    source: np.ndarray
    indices: np.ndarray
    starts: np.ndarray
    size: int

    @classmethod
    def of(cls, parts: tuple[Entries, Entries], speeds: np.ndarray, shape: tuple[int, int]):
        """The pattern for joints of a shape (m, n) and some of the speeds."""
        (row, column), (joint, speed) = parts
        m, n = shape
        place = np.full(n, -1)
        place[speeds] = np.arange(speeds.size)
        first = speeds.size
        rows = np.concatenate([place[row], first + joint, place[speed]])
        columns = np.concatenate([place[column], place[speed], first + joint])
        numbers = np.arange(row.size + joint.size)
        numbers = np.concatenate([numbers, row.size + np.arange(joint.size)])
        inside = np.flatnonzero((rows >= 0) & (columns >= 0))
        order = inside[np.lexsort((rows[inside], columns[inside]))]
        counts = np.bincount(columns[order], minlength=first + m)
        starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        return cls(parts, numbers[order], rows[order].astype(np.int32), starts, first + m)

    def fits(self, matrix: Matrix, joints: Matrix) -> bool:
        """Whether matrices have the stored entries."""
        return all(
            not scipy.sparse.issparse(part) or same_entries(part, entries)
            for part, entries in zip((matrix, joints), self.parts, strict=True)
        )

    def filled(self, matrix: Matrix, joints: Matrix) -> Matrix:
        """The matrix of some values."""
        pairs = zip((matrix, joints), self.parts, strict=True)
        values = [
            part.data if scipy.sparse.issparse(part) else part[entries] for part, entries in pairs
        ]
        data = np.concatenate(values)[self.source]
        shape = self.size, self.size
        return scipy.sparse.csc_array((data, self.indices, self.starts), shape=shape)


def stored_entries(part: Matrix, pattern: Entries) -> Entries:
    """Rows and columns of the stored entries of a sparse matrix; of a dense one, ``pattern``."""
    if not scipy.sparse.issparse(part):
        return pattern
    return np.repeat(np.arange(part.shape[0]), np.diff(part.indptr)), part.indices


def same_entries(part: Matrix, entries: Entries) -> bool:
    """Whether a matrix compressed by rows has these entries."""
    row, column = entries
    if part.indices is column:
        return True
    if part.indices.size != column.size or not np.array_equal(part.indices, column):
        return False
    return bool(np.array_equal(np.diff(part.indptr), np.bincount(row, minlength=part.shape[0])))
