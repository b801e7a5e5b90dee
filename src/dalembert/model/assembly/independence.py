"""Which columns of a sparse matrix are independent, taken in a prescribed order.

Columns are eliminated one after the other by orthogonal transformations of the rows they touch,
``A = Q R`` with the rows of R found one at a time. What is left of a column when its turn comes is
its part across the columns taken before it; too short a part leaves the column out. Only rows
that touch a column take part, so that the work grows with the number of columns where the graph
of the matrix is a chain, a tree or a net of loops (A. George and M. T. Heath, Linear Algebra
Appl. 34, 1980).
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cached_property
from itertools import count, pairwise

import casadi as ca
import numpy as np
import scipy

CLEARLY, BARELY = 0.05, 1e-6
"""Share of a column that is across the others, for it to be taken at first, and then."""
DEPENDENT = 1e-8
"""Share up to which a row of constraints follows from others."""
STANDING = 1e-5
"""Share of a column across the others below which what it is left of stands at an end of its way:
where that is a double root, half of the digits are lost."""
NOTHING = 1e-14
"""Entries of a matrix of unit rows or columns that are rounding."""


class Echelon:
    """Independent columns of a matrix and what the others are made of.

    Parameters
    ----------
    matrix : (m, n) sparse or dense, its rows or its columns of length one
    order : columns in the order in which they are taken; all by default
    thresholds : least share of a column across those taken, for one round after the other

    Attributes
    ----------
    pivots : independent columns in the order taken
    """

    def __init__(
        self,
        matrix,
        order: Iterable[int] | None = None,
        thresholds: Sequence[float] = (DEPENDENT,),
    ):
        by_row = scipy.sparse.csr_array(matrix)
        self.size = by_row.shape[1]
        waiting = list(range(self.size) if order is None else order)
        self._turn = np.zeros(self.size, dtype=int)
        self._turn[waiting] = np.arange(len(waiting))
        self._place = np.zeros(self.size, dtype=int)
        self._active: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        self._names = count()
        self._expected(())
        for start, end in pairwise(by_row.indptr):
            self._add(by_row.indices[start:end], by_row.data[start:end])
        norms = np.sqrt(np.bincount(by_row.indices, by_row.data**2, self.size))
        self._rows: list[tuple[int, np.ndarray, np.ndarray]] = []
        for threshold in thresholds:
            last = threshold == thresholds[-1]
            self._expected(waiting)
            waiting = [j for j in waiting if not self._take(j, threshold * norms[j], last)]
        self.pivots = [row[0] for row in self._rows]

    @property
    def free(self) -> list[int]:
        """The other columns."""
        return sorted(set(range(self.size)) - set(self.pivots))

    def kernel(self, values: Mapping[int, float]) -> np.ndarray:
        """(n,) the vector x with ``A x = 0`` and these values in the free columns, else 0."""
        x = np.zeros(self.size)
        x[list(values)] = list(values.values())
        waiting = [-row for column in values for row in self._rows_with.get(column, ())]
        heapq.heapify(waiting)
        last = len(self._rows)
        while waiting:  # from the last row that is touched upwards
            row = -heapq.heappop(waiting)
            if row < last:
                last = row
                pivot, columns, entries = self._rows[row]
                x[pivot] = -(entries[1:] @ x[columns]) / entries[0]
                if x[pivot]:
                    for above in self._rows_with.get(pivot, ()):
                        heapq.heappush(waiting, -above)
        return x

    def any_kernel(self, rng: np.random.Generator) -> np.ndarray:
        """(n,) a vector x with ``A x = 0`` in general direction, its largest entry one."""
        values = rng.standard_normal(len(self.free))
        x = self.kernel(dict(zip(self.free, values, strict=True)))
        return x / np.abs(x).max(initial=0.0) if x.any() else x

    @cached_property
    def _rows_with(self) -> dict[int, list[int]]:
        """Rows that have a column beside their pivot."""
        found: dict[int, list[int]] = {}
        for row, (_, columns, _) in enumerate(self._rows):
            for column in columns.tolist():
                found.setdefault(column, []).append(row)
        return found

    def _expected(self, waiting: Sequence[int]) -> None:
        """Begin a round with these columns.

        A row waits for the first of them that it touches: the columns before that one are taken, or
        were left out in this round. So whatever touches a column waits for it when its turn comes.
        """
        self._arriving = np.full(self.size, -1)
        self._arriving[list(waiting)] = self._turn[list(waiting)]
        self._now = -1
        self._waiting: dict[int, list[int]] = {}
        for name in self._active:
            self._wait(name)

    def _wait(self, name: int) -> None:
        columns = self._active[name][0]
        turns = self._arriving[columns]
        turns[turns <= self._now] = self.size
        first = turns.argmin()
        if turns[first] < self.size:
            self._waiting.setdefault(int(columns[first]), []).append(name)

    def _take(self, column: int, least: float, last: bool) -> bool:
        """Eliminate a column if enough is left of it; if not, its rest is dropped at last."""
        self._now = int(self._turn[column])
        names = sorted(self._waiting.pop(column, ()))
        touching = [self._active[name] for name in names]
        rest = [entries[columns == column][0] for columns, entries in touching]
        left = math.hypot(*rest)
        if not left > max(least, NOTHING):
            drop = last or left <= NOTHING
            for name in names:
                self._drop(name, column) if drop else self._wait(name)
            return False
        columns, block = self._merged(names, column)
        triangle = _triangular(block)
        self._rows.append((column, columns[1:], triangle[0]))
        for k, row in enumerate(triangle[1:], 1):
            self._add(columns[k:], row[k:])
        return True

    def _merged(self, names: list[int], first: int) -> tuple[np.ndarray, np.ndarray]:
        """The rows that touch a column, which stands first, the others in turn; they are removed.

        So what is left of them is triangular, and the next column touches few of them.
        """
        found = [self._active.pop(name) for name in names]
        columns = np.unique(np.concatenate([columns for columns, _ in found]))
        turn = self._turn[columns]
        turn[columns == first] = -1
        columns = columns[np.argsort(turn)]
        self._place[columns] = np.arange(columns.size)
        block = np.zeros((len(found), columns.size), order="F")
        for row, (at, entries) in enumerate(found):
            block[row, self._place[at]] = entries
        return columns, block

    def _add(self, columns: np.ndarray, entries: np.ndarray) -> None:
        """Keep what is more than rounding of a row."""
        large = np.abs(entries) > NOTHING
        if not large.all():
            columns, entries = columns[large], entries[large]
        if columns.size:
            name = next(self._names)
            self._active[name] = columns, entries
            self._wait(name)

    def _drop(self, name: int, column: int) -> None:
        """Forget what is left of a column in a row."""
        columns, entries = self._active.pop(name)
        self._add(columns[columns != column], entries[columns != column])


def rows_of(matrix, tolerance: float = DEPENDENT) -> Echelon:
    """Rows of a matrix, in order, that do not depend linearly on the rows before them.

    They are the columns of its transpose, each made of length one; one that has no length or is
    not finite is left out.
    """
    by_row = scipy.sparse.csr_array(matrix, dtype=float, copy=True)
    norms = np.sqrt(np.bincount(_row_of_entry(by_row), by_row.data**2, by_row.shape[0]))
    usable = np.isfinite(norms) & (norms > 0)
    factor = np.where(usable, 1.0 / np.where(usable, norms, 1.0), 0.0)
    by_row.data = np.where(usable[_row_of_entry(by_row)], by_row.data, 0.0)
    return Echelon((scipy.sparse.diags_array(factor) @ by_row).T, thresholds=(tolerance,))


def independent_rows(matrix, tolerance: float = DEPENDENT) -> list[int]:
    """Indices of the rows, in order, that do not depend linearly on the rows before them."""
    return rows_of(matrix, tolerance).pivots


def columns_of(matrix, order: Iterable[int] | None = None, least: float = DEPENDENT) -> Echelon:
    """Columns of a matrix whose rows count alike, in order, the clearly independent ones first.

    Parameters
    ----------
    matrix : (m, n), its rows are made of length one
    order : of the columns; their own by default
    least : share of a column across the others that is enough at last
    """
    return Echelon(_unit_rows(matrix), order, (CLEARLY, BARELY, least))


def determine_the_others(matrix, held: Collection[int]) -> bool:
    """Whether independent equations say clearly where all coordinates are but those held."""
    others = [k for k in range(matrix.shape[1]) if k not in held]
    return len(Echelon(_unit_rows(matrix), others, (CLEARLY, STANDING)).pivots) == len(others)


def free_columns(matrix, order: Sequence[int]) -> list[int]:
    """Coordinates that independent equations leave free, as early in the order as possible.

    The last ones are determined by the equations, as far as these clearly determine them.
    """
    determined = set(columns_of(matrix, reversed(order), 0.0).pivots)
    return [k for k in order if k not in determined][: matrix.shape[1] - matrix.shape[0]]


def least_fill(matrix) -> list[int]:
    """An order in which columns touch few others, for questions that any order answers.

    Approximate minimum degree (P. R. Amestoy, T. A. Davis and I. S. Duff, SIAM J. Matrix Anal.
    Appl. 17, 1996) of the columns that rows tie together.
    """
    by_row = scipy.sparse.csr_array(matrix)
    tied = scipy.sparse.csc_array(abs(by_row.T) @ abs(by_row))
    tied.sort_indices()
    rows, starts = tied.indices.tolist(), tied.indptr.tolist()
    graph = ca.Sparsity(tied.shape[0], tied.shape[1], starts, rows)
    return [int(k) for k in graph.amd()]


def _triangular(block: np.ndarray) -> np.ndarray:
    """The factor R of ``Q R``."""
    packed = scipy.linalg.lapack.dgeqrf(block, overwrite_a=True)[0]
    for row in range(1, min(block.shape)):
        packed[row, :row] = 0.0
    return packed[: min(block.shape)]


def _unit_rows(matrix) -> scipy.sparse.sparray:
    by_row = scipy.sparse.csr_array(matrix)
    norms = np.sqrt(np.bincount(_row_of_entry(by_row), by_row.data**2, by_row.shape[0]))
    return scipy.sparse.diags_array(1.0 / np.where(norms > 0, norms, 1.0)) @ by_row


def _row_of_entry(matrix: scipy.sparse.csr_array) -> np.ndarray:
    return np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
