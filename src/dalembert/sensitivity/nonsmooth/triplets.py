"""Small sparse matrices as triplets of rows, columns and values.

SciPy checks each matrix and each product, which takes longer than the products of the matrices of
one step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

Sparse = Any
"""A SciPy array compressed by rows, or ``Triplets``."""
MOST = 12_000
"""Upper limit of the multiplications of several columns without SciPy."""


@dataclass(frozen=True, eq=False, slots=True)
class Triplets:
    """Sum of entries of a matrix.

    Attributes
    ----------
    row, column, value : (m,) of the entries
    shape : numbers of rows and columns
    """

    row: np.ndarray
    column: np.ndarray
    value: np.ndarray
    shape: tuple[int, int]

    @classmethod
    def of(cls, matrix: Sparse) -> Triplets:
        """Entries of a matrix compressed by rows or by columns."""
        if isinstance(matrix, Triplets):
            return matrix
        lines = np.repeat(np.arange(matrix.indptr.size - 1), np.diff(matrix.indptr))
        row, column = lines, matrix.indices
        if matrix.format == "csc":
            row, column = column, row
        return cls(row, column, matrix.data, matrix.shape)

    def diagonal(self) -> np.ndarray:
        """Entries on the diagonal, each stored once."""
        diagonal, own = np.zeros(min(self.shape)), self.row == self.column
        diagonal[self.row[own]] = self.value[own]
        return diagonal

    @property
    def T(self) -> Triplets:
        """The transpose."""
        return Triplets(self.column, self.row, self.value, self.shape[::-1])

    def __matmul__(self, columns: np.ndarray) -> np.ndarray:
        """Product with columns (n, c)."""
        count = columns.shape[1]
        if count > 1 and count * self.value.size > MOST:
            return np.asarray(by_rows(self) @ columns)
        product = np.empty((self.shape[0], count))
        for k, own in enumerate(columns.T):
            values = self.value * own[self.column]
            product[:, k] = np.bincount(self.row, values, self.shape[0])
        return product


def by_rows(matrix: Sparse) -> Sparse:
    """A matrix as a SciPy array compressed by rows."""
    if not isinstance(matrix, Triplets):
        return matrix
    return scipy.sparse.csr_array((matrix.value, (matrix.row, matrix.column)), matrix.shape)


class DiagonalBlocks:
    """Blocks of a block-diagonal matrix with equally many columns.

    Parameters
    ----------
    matrix : compressed by rows
    first : (K + 1,) first row of each block, and the number of rows
    """

    def __init__(self, matrix: Sparse, first: np.ndarray):
        count = first.size - 1
        self._width, self._sizes = matrix.shape[1] // count, np.diff(first)
        block = np.repeat(np.arange(count), self._sizes)
        row = np.arange(block.size) - first[block]
        lines = np.diff(matrix.indptr)
        self._row, block = np.repeat(row, lines), np.repeat(block, lines)
        self._column, self._value = matrix.indices - self._width * block, matrix.data
        self._first = matrix.indptr[first]

    def at(self, k: int) -> Triplets:
        """Block ``k``."""
        own = slice(*self._first[k : k + 2])
        shape = int(self._sizes[k]), self._width
        return Triplets(self._row[own], self._column[own], self._value[own], shape)
