"""Tangents as sparse triangular systems, whose entries are computed once for many directions.

A tangent is a sequence of sums ``v_i = Σ_j a_ij v_j`` of earlier values, the direction first and
the rates last. So it is the solution of ``(I − A) v = [u; 0]`` with a sparse, unit lower
triangular matrix (the extended Jacobian of Griewank and Walther, *Evaluating Derivatives*, 2008,
chapter 9), and its adjoint the solution with the transposed matrix. The entries depend on the
point only. Each further direction costs one substitution, which runs in compiled code.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise

import casadi as ca
import numpy as np

from dalembert.symbolic.evaluation.kernel import condensed
from dalembert.symbolic.evaluation.tape import Tape

MAX_WIDTH, CACHED_NUMBERS = 16, 1 << 16
"""Upper limits of the directions solved at once and of their numbers; chosen to fit the cache."""

Term = tuple[int, int | None, float]
"""Row, entry or None, and the number that multiplies it."""


class LinearMap:
    """Tangent of a function at a point, as one triangular matrix.

    Parameters
    ----------
    tangent : SX function of ``fixed`` inputs and then of directions, linear in these
    fixed : number of inputs that define the point
    values : SX functions of the point, evaluated together with the entries

    Attributes
    ----------
    point : SX function, point → values, entries that are not constant
    sums : terms of every row after those of the directions
    input_count, output_count : lengths of the stacked directions and rates
    """

    def __init__(self, tangent: ca.Function, fixed: int, values: Sequence[ca.Function] = ()):
        tape = Tape(tangent, fixed)
        self.input_count, self.output_count = tape.input_count, tape.output_count
        entry_numbers: dict[tuple[int, float], int] = {}
        entries: list[ca.SX] = []
        numbers: list[float] = []
        self.sums: list[list[Term]] = []
        for terms in tape.sums[tape.input_count :]:
            row: list[Term] = []
            for source, factor in terms.items():
                if factor.entry is None:
                    row.append((source, None, factor.number))
                    continue
                key = (factor.entry.element_hash(), factor.number)
                if key not in entry_numbers:
                    entry_numbers[key] = len(entries)
                    entries.append(factor.entry)
                    numbers.append(-factor.number)
                row.append((source, entry_numbers[key], 1.0))
            self.sums.append(row)
        stacked = ca.densify(ca.DM(numbers) * ca.vertcat(*entries)) if entries else ca.SX(0, 1)
        value_outputs = [part for value in values for part in value.call(tape.point)]
        self.point = condensed("point", tape.point, [*value_outputs, stacked])


class LinearChain:
    """A sequence of linear maps as one triangular matrix.

    Rows are numbered in order of creation, the directions first.

    Parameters
    ----------
    input_count : length of the stacked directions
    """

    def __init__(self, input_count: int):
        self.input_count = self.count = input_count
        self._row: list[int] = []
        self._column: list[int] = []
        self._pick: list[int] = []  # index into the pool of entries; numbers count from −1 down
        self._pool: list[ca.MX] = []
        self._size = 0
        self._numbers: dict[float, int] = {}
        self._shared_rows: dict[tuple[Term, ...], int] = {}

    def weighted(self, parts: Sequence[tuple[Sequence[int], ca.MX | float]]) -> list[int]:
        """Rows ``Σ weight · rows``."""
        new_rows = self._new(len(parts[0][0]))
        for rows, weight in parts:
            pick = self._number(-weight) if isinstance(weight, float) else self._entries(-weight)
            self._row += new_rows
            self._column += rows
            self._pick += [pick] * len(new_rows)
        return new_rows

    def through(self, block: LinearMap, inputs: Sequence[int], entries: ca.MX) -> list[int]:
        """Rows of a map's outputs for these rows as its inputs."""
        place, begin = list(inputs), self._entries(entries)
        last = len(block.sums) - block.output_count
        for k, terms in enumerate(block.sums):
            row_terms = [(place[source], entry, number) for source, entry, number in terms]
            constant = k < last and all(entry is None for _, entry, _ in row_terms)
            place.append(
                self._shared(tuple(row_terms)) if constant else self._sum(row_terms, begin)
            )
        return place[len(place) - block.output_count :]

    def closed(self, outputs: Sequence[int]) -> TriangularMap:
        """The map from the directions to the rows ``outputs``."""
        used_inputs = np.unique([c for c in self._column if c < self.input_count])
        used_inputs = np.union1d(used_inputs, [r for r in outputs if r < self.input_count]).astype(
            int
        )
        position = np.full(self.count, -1)
        position[used_inputs] = np.arange(used_inputs.size)
        position[self.input_count :] = used_inputs.size + np.arange(self.count - self.input_count)
        size = used_inputs.size + self.count - self.input_count
        pool = ca.vertcat(*self._pool), ca.DM(list(self._numbers))
        pick = [k if k >= 0 else self._size - 1 - k for k in self._pick]
        triplets = (position[self._row], position[self._column], np.array(pick, dtype=int))
        return TriangularMap(
            triplets, pool, size, (self.input_count, used_inputs), position[list(outputs)]
        )

    def _sum(self, terms: Sequence[Term], begin: int) -> int:
        """A row with these terms, whose entries begin at ``begin`` in the pool."""
        sources = self._distinct([source for source, _, _ in terms])
        (row,) = self._new(1)
        for source, (_, entry, number) in zip(sources, terms, strict=True):
            self._row.append(row)
            self._column.append(source)
            self._pick.append(self._number(-number) if entry is None else begin + entry)
        return row

    def _distinct(self, rows: Sequence[int]) -> list[int]:
        """The rows, with copies of repeated ones: a place in the matrix holds one entry."""
        distinct: dict[int, None] = {}
        for row in rows:
            distinct[self.weighted([([row], 1.0)])[0] if row in distinct else row] = None
        return list(distinct)

    def _shared(self, terms: tuple[Term, ...]) -> int:
        """A row of numbers only, such as a sum of parameters, shared by all maps."""
        if terms not in self._shared_rows:
            self._shared_rows[terms] = self._sum(terms, 0)
        return self._shared_rows[terms]

    def _new(self, count: int) -> list[int]:
        self.count += count
        return list(range(self.count - count, self.count))

    def _entries(self, entries: ca.MX) -> int:
        self._pool.append(entries)
        self._size += entries.numel()
        return self._size - entries.numel()

    def _number(self, number: float) -> int:
        return -self._numbers.setdefault(number, len(self._numbers) + 1)


class TriangularMap:
    """A linear map given by a unit lower triangular matrix of MX entries.

    Its diagonal is left out: CasADi's substitution takes a missing diagonal entry as one, and a
    stored one costs a division.

    Parameters
    ----------
    triplets : row, column and index in ``pool`` of every entry below the diagonal
    pool : MX entries, followed by numbers
    size : of the matrix
    inputs : length of the directions, and the used ones, which are the first rows
    outputs : rows of the rates
    """

    def __init__(self, triplets, pool: tuple[ca.MX, ca.DM], size: int, inputs, outputs: np.ndarray):
        self.row, self.column, self.pick = triplets
        (self.entries, self._numbers), self.size = pool, size
        self.pool = ca.vertcat(*pool)
        self.input_count, self.used = inputs
        self.outputs = [int(k) for k in outputs]

    def tangent(self, directions: Sequence[ca.MX]) -> ca.MX:
        """Rates (outputs, m) for directions (inputs, m), given in blocks of rows."""
        width = max(1, min(MAX_WIDTH, CACHED_NUMBERS // self.size))
        cuts = [*range(0, directions[0].shape[1], width), directions[0].shape[1]]
        blocks = [
            self._tangent([block[:, begin:end] for block in directions])
            for begin, end in pairwise(cuts)
        ]
        return ca.horzcat(*blocks)

    def _tangent(self, directions: Sequence[ca.MX]) -> ca.MX:
        begin, rhs = 0, ca.MX(self.size, directions[0].shape[1])
        for block in directions:
            end = begin + block.shape[0]
            rows = np.flatnonzero((self.used >= begin) & (self.used < end))
            part = block[[int(k) for k in self.used[rows] - begin], :]
            rhs, begin = rhs + _placed(part, self.size, rows), end
        return _substituted(self._lower, ca.densify(rhs))[self.outputs, :]

    def along(self, sizes: Sequence[int]) -> ca.Function:
        """``(entries, direction) → rates`` in scalars, with blocks of these sizes."""
        triplets = self.row, self.column, self.pick
        pool = ca.MX.sym("e", self.entries.numel()), self._numbers
        copy = TriangularMap(
            triplets, pool, self.size, (self.input_count, self.used), np.array(self.outputs)
        )
        blocks = [ca.MX.sym(f"d{k}", size) for k, size in enumerate(sizes)]
        return ca.Function("along", [pool[0], *blocks], [copy.tangent(blocks)]).expand()

    def adjoint(self, weights: ca.MX) -> ca.MX:
        """Weights (inputs,) of the directions for weights (outputs,) of the rates."""
        rhs = ca.densify(_placed(weights, self.size, np.array(self.outputs)))
        solved = _substituted(self._matrix(self.column, self.row), rhs)
        return ca.densify(_placed(solved[: self.used.size, :], self.input_count, self.used))

    @cached_property
    def _lower(self) -> ca.MX:
        return self._matrix(self.row, self.column)

    def _matrix(self, row: np.ndarray, column: np.ndarray) -> ca.MX:
        order = np.lexsort((row, column))
        pattern = ca.Sparsity.triplet(
            self.size, self.size, row[order].tolist(), column[order].tolist()
        )
        return ca.MX(pattern, ca.vec(self.pool[self.pick[order].tolist()]))


def _substituted(matrix: ca.MX, rhs: ca.MX) -> ca.MX:
    """Solution with a unit triangular matrix stored without its diagonal."""
    return ca.solve(matrix, rhs) if matrix.nnz() else rhs


def _placed(block: ca.MX, rows: int, positions: np.ndarray) -> ca.MX:
    """A sparse matrix of ``rows`` rows with the rows of the block at increasing positions."""
    pattern = ca.Sparsity.dense(*block.shape)
    pattern.enlargeRows(rows, [int(k) for k in positions])
    return ca.sparsity_cast(ca.densify(block), pattern)
