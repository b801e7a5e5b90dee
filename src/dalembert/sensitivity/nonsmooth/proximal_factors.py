"""Factors of sparse matrices that may be singular, for both directions.

The factors of ``G + ε D`` solve ``G z = r`` by proximal iterations, ``z ← z + (G + ε D)⁻¹ (r −
G z)``; unique quantities do not depend on ``ε``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from dalembert.errors import SingularityError
from dalembert.sensitivity.nonsmooth.slope_function import Sparse
from dalembert.sparse.factorise import SuperLUFactors

WEIGHT, ITERATIONS = 1e-9, 3
"""``ε``, relative to the entries of a row; number of proximal iterations."""
REMAINDER = 1e-6
"""Remainder of equations that count as consistent, relative to the right-hand side [-]."""
Block = tuple[int, int, Sparse]
"""First row, first column and entries of a block of a matrix."""


class Entries:
    """Entries of a sparse matrix, added one after the other."""

    def __init__(self) -> None:
        self._parts: list[tuple[np.ndarray, ...]] = []

    def add(self, rows: np.ndarray, columns: np.ndarray, values: np.ndarray) -> None:
        """Add values at rows and columns, all (m,)."""
        used = values != 0
        self._parts.append((values[used], rows[used], columns[used]))

    def matrix(self, shape: tuple[int, int]) -> Sparse:
        """The sum."""
        values, rows, columns = (np.concatenate(p) for p in zip(*self._parts, strict=True))
        return scipy.sparse.csr_array((values, (rows, columns)), shape=shape)


class ProximalFactors:
    """Factors of a matrix that may be singular, for both directions.

    Parameters
    ----------
    blocks : of the matrix
    weight : (n,) diagonal of ``D``: 1 for impulses, −1 for joint multipliers, 0 for speeds

    Attributes
    ----------
    consistent : whether all equations solved so far were consistent

    Raises
    ------
    SingularityError
        The equations cannot be factorised.
    """

    def __init__(self, blocks: Sequence[Block], weight: np.ndarray):
        parts = [_entries(*block) for block in blocks]
        row, column, value = (np.concatenate(part) for part in zip(*parts, strict=True))
        n, smallest = weight.size, np.finfo(float).tiny
        largest = np.full(n, smallest)
        np.maximum.at(largest, row, np.abs(value))
        self.rows = 1 / largest
        value = value * self.rows[row]
        largest = np.full(n, smallest)
        np.maximum.at(largest, column, np.abs(value))
        self.columns = 1 / largest
        value = value * self.columns[column]
        self.matrix = _compressed(value, row, column, n)
        diagonal = np.arange(n)
        row, column = (np.concatenate([part, diagonal]) for part in (row, column))
        shifted = _compressed(np.concatenate([value, WEIGHT * weight]), row, column, n)
        try:
            self._factors = SuperLUFactors(shifted)
        except np.linalg.LinAlgError:
            text = "a step with contacts has no derivative: its equations are singular"
            raise SingularityError(text) from None
        self.consistent = True

    def solve(self, right: np.ndarray, transposed: bool = False) -> np.ndarray:
        """Solution, the same linear map and its transpose."""
        before, after = (self.columns, self.rows) if transposed else (self.rows, self.columns)
        matrix, trans = (self.matrix.T, "T") if transposed else (self.matrix, "N")
        rhs = before[:, None] * right.reshape(right.shape[0], -1)
        solution, remainder = np.zeros(rhs.shape), rhs
        for _ in range(ITERATIONS):
            solution = solution + self._factors.solve(remainder, trans)
            remainder = rhs - matrix @ solution
        size = np.abs(rhs).max(initial=0.0)
        self.consistent &= bool(np.abs(remainder).max(initial=0.0) <= REMAINDER * size)
        return (after[:, None] * solution).reshape(right.shape)


def _entries(first: int, left: int, matrix: Sparse) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    row = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
    return first + row, left + matrix.indices, matrix.data


def _compressed(
    value: np.ndarray, row: np.ndarray, column: np.ndarray, n: int
) -> scipy.sparse.csc_array:
    return scipy.sparse.csc_array((value, (row, column)), shape=(n, n))
