"""Independent columns of a sparse matrix, selected in a prescribed order.

Columns are eliminated in sequence by orthogonal transformations of the rows with an entry in them,
``A = Q R`` with one row of R per column. The remainder of a column is its component orthogonal to
the columns selected before; a column with too small a remainder is left out. Only rows with an
entry in a column take part, so that the work grows linearly with the number of columns if the
graph of the matrix is a chain, a tree or a net of loops (A. George and M. T. Heath, Linear Algebra
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
"""Thresholds for the orthogonal component of a column, in the first and the second round."""
DEPENDENT = 1e-8
"""Threshold for a redundant row of constraints."""
EXTREMAL = 1e-5
"""Threshold for a coordinate at an extremum, a double root, where half of the digits are lost."""
NEGLIGIBLE = 1e-14
"""Threshold for rounding in the entries of unit rows or columns."""


class Echelon:
    """Independent columns of a matrix, and the null space of the matrix.

    Parameters
    ----------
    matrix : (m, n) sparse or dense, its rows or its columns of unit length
    order : order of selection of the columns; all by default
    thresholds : lower limit of the orthogonal component of a column, one for each round

    Attributes
    ----------
    pivots : independent columns in the order of selection
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
        self._begin_round(())
        for start, end in pairwise(by_row.indptr):
            self._add(by_row.indices[start:end], by_row.data[start:end])
        norms = np.sqrt(np.bincount(by_row.indices, by_row.data**2, self.size))
        self._rows: list[tuple[int, np.ndarray, np.ndarray]] = []
        for threshold in thresholds:
            last = threshold == thresholds[-1]
            self._begin_round(waiting)
            waiting = [j for j in waiting if not self._eliminate(j, threshold * norms[j], last)]
        self.pivots = [row[0] for row in self._rows]

    @property
    def free(self) -> list[int]:
        """The dependent columns."""
        return sorted(set(range(self.size)) - set(self.pivots))

    def kernel(self, values: Mapping[int, float]) -> np.ndarray:
        """(n,) null vector, ``A x = 0``, with these values in free columns and zero in the rest."""
        x = np.zeros(self.size)
        x[list(values)] = list(values.values())
        waiting = [-row for column in values for row in self._rows_with.get(column, ())]
        heapq.heapify(waiting)
        last = len(self._rows)
        while waiting:  # from the last affected row upwards
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
        """(n,) null vector, ``A x = 0``, of random direction, with a largest entry of one."""
        values = rng.standard_normal(len(self.free))
        x = self.kernel(dict(zip(self.free, values, strict=True)))
        return x / np.abs(x).max(initial=0.0) if x.any() else x

    @cached_property
    def _rows_with(self) -> dict[int, list[int]]:
        """Column → rows with an entry in it other than their pivot."""
        rows: dict[int, list[int]] = {}
        for row, (_, columns, _) in enumerate(self._rows):
            for column in columns.tolist():
                rows.setdefault(column, []).append(row)
        return rows

    def _begin_round(self, waiting: Sequence[int]) -> None:
        """Begin a round with these columns.

        A row waits for the first of them with an entry: the columns before are selected, or were
        left out in this round. So all rows with an entry in a column wait for it at its turn.
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

    def _eliminate(self, column: int, least: float, last: bool) -> bool:
        """Eliminate a column with a sufficient remainder; drop the remainder in the last round."""
        self._now = int(self._turn[column])
        names = sorted(self._waiting.pop(column, ()))
        touching = [self._active[name] for name in names]
        column_entries = [entries[columns == column][0] for columns, entries in touching]
        remainder = math.hypot(*column_entries)
        if not remainder > max(least, NEGLIGIBLE):
            drop = last or remainder <= NEGLIGIBLE
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
        """Remove the rows with an entry in a column, as a block with this column first.

        The other columns are in order, so that the remaining rows are triangular and few of them
        have an entry in the next column.
        """
        rows = [self._active.pop(name) for name in names]
        columns = np.unique(np.concatenate([columns for columns, _ in rows]))
        turn = self._turn[columns]
        turn[columns == first] = -1
        columns = columns[np.argsort(turn)]
        self._place[columns] = np.arange(columns.size)
        block = np.zeros((len(rows), columns.size), order="F")
        for row, (row_columns, entries) in enumerate(rows):
            block[row, self._place[row_columns]] = entries
        return columns, block

    def _add(self, columns: np.ndarray, entries: np.ndarray) -> None:
        """Add the entries of a row that are more than rounding."""
        large = np.abs(entries) > NEGLIGIBLE
        if not large.all():
            columns, entries = columns[large], entries[large]
        if columns.size:
            name = next(self._names)
            self._active[name] = columns, entries
            self._wait(name)

    def _drop(self, name: int, column: int) -> None:
        """Remove the remainder of a column from a row."""
        columns, entries = self._active.pop(name)
        self._add(columns[columns != column], entries[columns != column])


def rows_of(matrix, tolerance: float = DEPENDENT) -> Echelon:
    """Echelon of the rows of a matrix, selected in order; the pivots are independent rows.

    Rows are columns of the transpose, normalised; rows that are zero or not finite are left out.
    """
    by_row = scipy.sparse.csr_array(matrix, dtype=float, copy=True)
    norms = np.sqrt(np.bincount(_row_of_entry(by_row), by_row.data**2, by_row.shape[0]))
    usable = np.isfinite(norms) & (norms > 0)
    factor = np.where(usable, 1.0 / np.where(usable, norms, 1.0), 0.0)
    by_row.data = np.where(usable[_row_of_entry(by_row)], by_row.data, 0.0)
    return Echelon((scipy.sparse.diags_array(factor) @ by_row).T, thresholds=(tolerance,))


def independent_rows(matrix, tolerance: float = DEPENDENT) -> list[int]:
    """Indices of the rows that do not depend linearly on the rows before them."""
    return rows_of(matrix, tolerance).pivots


def columns_of(matrix, order: Iterable[int] | None = None, least: float = DEPENDENT) -> Echelon:
    """Echelon of the columns of a matrix with normalised rows, clearly independent ones first.

    Parameters
    ----------
    matrix : (m, n), its rows are normalised
    order : of the columns; by index by default
    least : lower limit of the orthogonal component in the last round
    """
    return Echelon(_unit_rows(matrix), order, (CLEARLY, BARELY, least))


def determine_dependent(matrix, fixed: Collection[int]) -> bool:
    """Whether independent equations clearly determine all coordinates except the fixed ones."""
    dependent = [k for k in range(matrix.shape[1]) if k not in fixed]
    pivots = Echelon(_unit_rows(matrix), dependent, (CLEARLY, EXTREMAL)).pivots
    return len(pivots) == len(dependent)


def free_columns(matrix, order: Sequence[int]) -> list[int]:
    """Coordinates that independent equations leave free, as early in the order as possible.

    The equations determine the last coordinates, as far as they do so clearly.
    """
    determined = set(columns_of(matrix, reversed(order), 0.0).pivots)
    return [k for k in order if k not in determined][: matrix.shape[1] - matrix.shape[0]]


def least_fill(matrix) -> list[int]:
    """Column order of small fill-in, if the result does not depend on the order.

    Approximate minimum degree (P. R. Amestoy, T. A. Davis and I. S. Duff, SIAM J. Matrix Anal.
    Appl. 17, 1996) of the columns coupled by rows.
    """
    by_row = scipy.sparse.csr_array(matrix)
    coupled = scipy.sparse.csc_array(abs(by_row.T) @ abs(by_row))
    coupled.sort_indices()
    rows, starts = coupled.indices.tolist(), coupled.indptr.tolist()
    graph = ca.Sparsity(coupled.shape[0], coupled.shape[1], starts, rows)
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
