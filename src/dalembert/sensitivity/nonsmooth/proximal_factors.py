"""Factors of sparse matrices that may be singular, for both directions.

The factors of ``G + ε D`` solve ``G z = r`` by proximal iterations, ``z ← z + (G + ε D)⁻¹ (r −
G z)``; unique quantities do not depend on ``ε``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
import scipy

from dalembert.errors import SingularityError
from dalembert.sensitivity.nonsmooth.jammed_contacts import SmallestImpulses
from dalembert.sensitivity.nonsmooth.triplets import Sparse, Triplets
from dalembert.sparse.factorise import DenseFactors, SuperLUFactors
from dalembert.sparse.solver import Factors

WEIGHT, ITERATIONS = 1e-9, 3
"""``ε``, relative to the entries of a row; number of proximal iterations."""
SOLVED = 1e-14
"""Remainder of equations that further iterations do not reduce, relative to the right-hand side
[-]."""
REMAINDER = 1e-6
"""Remainder of equations that count as consistent, relative to the right-hand side [-]."""
UNLIMITED, LARGEST = 1e4, 2000
"""Scaled speeds by an arbitrary right-hand side that count as unlimited; upper limit of the
impulses of a step whose equations are then solved by least squares."""
DENSE = 200
"""Upper limit of the equations whose factors are dense; sparse ones have a longer start."""
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


@dataclass(frozen=True, eq=False)
class ScaledMatrix:
    """Matrix whose rows and columns are scaled to entries of one.

    Attributes
    ----------
    rows, columns : (n,) factors of the rows and columns of ``G``
    shift : (n,) diagonal ``ε D``
    entries : of scaled ``G``, plus ``ε D``
    starts : (n + 1,) first entries of the columns, if they are ordered by these
    """

    rows: np.ndarray
    columns: np.ndarray
    shift: np.ndarray
    entries: Triplets
    starts: np.ndarray | None = None

    @classmethod
    def of(
        cls, blocks: Sequence[Block], weight: np.ndarray, place: np.ndarray | None = None
    ) -> ScaledMatrix:
        """Scale a matrix.

        Parameters
        ----------
        blocks : of the matrix
        weight : (n,) diagonal of ``D``: 1 for impulses, −1 for joint multipliers, 0 for speeds
        place : (n,) new numbers of the rows and columns; the same by default
        """
        parts = [entries_of(block) for block in blocks]
        row = np.concatenate([part.row for part in parts])
        column = np.concatenate([part.column for part in parts])
        value = np.concatenate([part.value for part in parts])
        n, smallest = weight.size, np.finfo(float).tiny
        if place is not None:
            row, column = place[row], place[column]
            weight = weight[np.argsort(place)]
        largest = np.full(n, smallest)
        np.maximum.at(largest, row, np.abs(value))
        rows = 1 / largest
        value = value * rows[row]
        largest = np.full(n, smallest)
        np.maximum.at(largest, column, np.abs(value))
        columns = 1 / largest
        value = value * columns[column]
        diagonal, shift = np.arange(n), WEIGHT * weight
        row, column = (np.concatenate([part, diagonal]) for part in (row, column))
        entries = Triplets(row, column, np.concatenate([value, shift]), (n, n))
        return cls(rows, columns, shift, entries)

    @property
    def by_columns(self) -> ScaledMatrix:
        """The same with its entries ordered by columns."""
        shifted = self.shifted
        return replace(self, entries=Triplets.of(shifted), starts=shifted.indptr)

    def block(self, begin: int, end: int) -> ScaledMatrix:
        """A diagonal block that no other entries couple to the rest, of entries by columns."""
        assert self.starts is not None
        starts, size, whole = self.starts[begin : end + 1], end - begin, self.entries
        inside, own = slice(begin, end), slice(starts[0], starts[-1])
        row, column = whole.row[own] - begin, whole.column[own] - begin
        entries = Triplets(row, column, whole.value[own], (size, size))
        diagonals = self.rows[inside], self.columns[inside], self.shift[inside]
        return ScaledMatrix(*diagonals, entries, starts - starts[0])

    @property
    def shifted(self) -> Sparse:
        """Scaled ``G``, plus ``ε D``, compressed by columns."""
        own, starts = self.entries, self.starts
        parts = (
            (own.value, (own.row, own.column)) if starts is None else (own.value, own.row, starts)
        )
        return scipy.sparse.csc_array(parts, shape=own.shape)

    def factors(self) -> Factors:
        """Factors of ``shifted``, dense ones if it is small.

        Raises
        ------
        numpy.linalg.LinAlgError
            A pivot vanishes, or an entry is not finite.
        """
        if self.shift.size > DENSE:
            return SuperLUFactors(self.shifted)
        own, n = self.entries, self.shift.size
        dense = np.bincount(own.row + n * own.column, own.value, n * n)
        return DenseFactors(dense.reshape(n, n).T)


class ProximalFactors:
    """Factors of a matrix that may be singular, for both directions.

    Parameters
    ----------
    scaled : the matrix

    Attributes
    ----------
    consistent : whether all equations solved so far were consistent

    Raises
    ------
    SingularityError
        The equations cannot be factorised.
    """

    def __init__(self, scaled: ScaledMatrix):
        self._scaled = scaled
        try:
            self._factors = scaled.factors()
        except np.linalg.LinAlgError:
            text = "a step with contacts has no derivative: its equations are singular"
            raise SingularityError(text) from None
        self.consistent = True

    @classmethod
    def of(cls, blocks: Sequence[Block], weight: np.ndarray) -> ProximalFactors:
        """Factors of a matrix; arguments as in ``ScaledMatrix.of``."""
        return cls(ScaledMatrix.of(blocks, weight))

    def solve(self, right: np.ndarray, transposed: bool = False) -> np.ndarray:
        """Solution, the same linear map and its transpose."""
        before, after, trans = self._scaled.rows, self._scaled.columns, "N"
        if transposed:
            before, after, trans = after, before, "T"
        rhs = before[:, None] * right.reshape(right.shape[0], -1)
        if self._jammed is not None:
            solution = self._jammed.solve(rhs, transposed)
            remainder = rhs - self._product(solution, transposed)
            size, largest = np.abs(rhs).max(initial=0.0), np.abs(remainder).max(initial=0.0)
            self.consistent &= bool(largest <= REMAINDER * size)
            return (after[:, None] * solution).reshape(right.shape)
        solution, remainder, size = np.zeros(rhs.shape), rhs, np.abs(rhs).max(initial=0.0)
        for _ in range(ITERATIONS):
            solution = solution + self._factors.solve(remainder, trans)
            remainder = rhs - self._product(solution, transposed)
            largest = np.abs(remainder).max(initial=0.0)
            if largest <= SOLVED * size:
                break
        self.consistent &= bool(largest <= REMAINDER * size)
        return (after[:, None] * solution).reshape(right.shape)

    @property
    def size(self) -> int:
        """Number of equations."""
        return self._scaled.shift.size

    @cached_property
    def regular(self) -> bool:
        """Whether an arbitrary right-hand side is consistent: the matrix is not singular."""
        right = arbitrary(self.size)
        remainder = right - self._product(self._factors.solve(right))
        return bool(
            np.abs(remainder).max(initial=0.0) <= REMAINDER * np.abs(right).max(initial=0.0)
        )

    @cached_property
    def _jammed(self) -> SmallestImpulses | None:
        """Solution with the smallest impulses, if contradictory equations have unlimited speeds."""
        impulses = self._scaled.shift > 0
        if self.regular or np.count_nonzero(impulses) > LARGEST:
            return None
        speeds = self._factors.solve(arbitrary(self.size))[~impulses]
        if np.abs(speeds).max(initial=0.0) <= UNLIMITED:
            return None
        scaled = self._scaled
        matrix = scaled.shifted - scipy.sparse.diags_array(np.where(impulses, scaled.shift, 0.0))
        try:
            return SmallestImpulses(matrix, impulses)
        except np.linalg.LinAlgError:
            return None

    def _product(self, columns: np.ndarray, transposed: bool = False) -> np.ndarray:
        """The scaled matrix, or its transpose, times columns (n, c)."""
        entries = self._scaled.entries
        matrix = entries.T if transposed else entries
        return matrix @ columns - self._scaled.shift[:, None] * columns


@lru_cache
def arbitrary(size: int) -> np.ndarray:
    """An arbitrary column (size, 1)."""
    return np.random.default_rng(0).normal(size=(size, 1))


def diagonal_block(matrix: Sparse, begin: int, end: int, left: int, width: int = 0) -> Sparse:
    """Block of a block-diagonal compressed matrix: rows, or columns if compressed by these, from
    ``begin`` to ``end``, and of the others ``width`` from ``left`` on, by default as many."""
    width = width or end - begin
    starts = matrix.indptr[begin : end + 1]
    own = slice(starts[0], starts[-1])
    parts = matrix.data[own], matrix.indices[own] - left, starts - starts[0]
    shape = (end - begin, width) if matrix.format == "csr" else (width, end - begin)
    return type(matrix)(parts, shape=shape)


def entries_of(block: Block) -> Triplets:
    """Entries of a block in the whole matrix, of the same shape."""
    first, left, own = block[0], block[1], Triplets.of(block[2])
    return Triplets(first + own.row, left + own.column, own.value, own.shape)
