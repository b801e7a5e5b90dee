"""Tangents as sparse triangular systems, whose entries are computed once for many directions.

What a tangent does with a direction is a sequence of sums ``v_i = Σ_j a_ij v_j`` of what came
before, the direction first and the rates last. So it is the solution of ``(I − A) v = [u; 0]``
with a sparse, unit lower triangular matrix (the extended Jacobian of Griewank and Walther,
*Evaluating Derivatives*, 2008, chapter 9), and its adjoint the solution with the transposed one.
The entries depend on the point only. Each further direction costs one substitution, which runs in
compiled code whatever evaluates the graph.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise

import casadi as ca
import numpy as np

from dalembert.symbolic.evaluation.condensed import condensed
from dalembert.symbolic.evaluation.tape import Tape

WIDTH, NEAR = 16, 1 << 16
"""Directions solved for at once, at most, and numbers of them that stay near the processor."""


Term = tuple[int, int | None, float]
"""Row, entry or None, and the number that multiplies it."""


class LinearMap:
    """Tangent of a function at a point, as one triangular matrix.

    Parameters
    ----------
    tangent : SX function of ``fixed`` inputs and then of directions, linear in these
    fixed : how many inputs make the point
    values : SX functions of the point that are wanted beside the entries

    Attributes
    ----------
    point : SX function, point → values, entries that are not constant
    sums : terms of every row after those of the directions
    input_count, output_count : lengths of the stacked directions and rates
    """

    def __init__(self, tangent: ca.Function, fixed: int, values: Sequence[ca.Function] = ()):
        tape = Tape(tangent, fixed)
        self.input_count, self.output_count = tape.input_count, tape.output_count
        known: dict[tuple[int, float], int] = {}
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
                if key not in known:
                    known[key] = len(entries)
                    entries.append(factor.entry)
                    numbers.append(-factor.number)
                row.append((source, known[key], 1.0))
            self.sums.append(row)
        stacked = ca.densify(ca.DM(numbers) * ca.vertcat(*entries)) if entries else ca.SX(0, 1)
        given = [part for value in values for part in value.call(tape.point)]
        self.point = condensed("point", tape.point, [*given, stacked])


class LinearChain:
    """Linear maps one after the other, as one triangular matrix.

    Rows are numbered as they are made, the directions first.

    Parameters
    ----------
    input_count : length of the stacked directions
    """

    def __init__(self, input_count: int):
        self.input_count = self.count = input_count
        self._row: list[int] = []
        self._column: list[int] = []
        self._where: list[int] = []  # in the pool of entries; numbers count from −1 down
        self._pool: list[ca.MX] = []
        self._size = 0
        self._numbers: dict[float, int] = {}
        self._known: dict[tuple[Term, ...], int] = {}

    def weighted(self, parts: Sequence[tuple[Sequence[int], ca.MX | float]]) -> list[int]:
        """Rows ``Σ weight · rows``."""
        made = self._new(len(parts[0][0]))
        for rows, weight in parts:
            where = self._number(-weight) if isinstance(weight, float) else self._entries(-weight)
            self._row += made
            self._column += rows
            self._where += [where] * len(made)
        return made

    def through(self, block: LinearMap, inputs: Sequence[int], entries: ca.MX) -> list[int]:
        """Rows of a map's outputs for these rows as its inputs."""
        place, begin = list(inputs), self._entries(entries)
        last = len(block.sums) - block.output_count
        for k, terms in enumerate(block.sums):
            given = [(place[source], entry, number) for source, entry, number in terms]
            plain = k < last and all(entry is None for _, entry, _ in given)
            place.append(self._shared(tuple(given)) if plain else self._sum(given, begin))
        return place[len(place) - block.output_count :]

    def closed(self, outputs: Sequence[int]) -> TriangularMap:
        """The map from the directions to these rows."""
        used = np.unique([c for c in self._column if c < self.input_count])
        used = np.union1d(used, [r for r in outputs if r < self.input_count]).astype(int)
        place = np.full(self.count, -1)
        place[used] = np.arange(used.size)
        place[self.input_count :] = used.size + np.arange(self.count - self.input_count)
        size = used.size + self.count - self.input_count
        pool = ca.vertcat(*self._pool), ca.DM(list(self._numbers))
        where = [k if k >= 0 else self._size - 1 - k for k in self._where]
        triplets = (place[self._row], place[self._column], np.array(where, dtype=int))
        return TriangularMap(triplets, pool, size, (self.input_count, used), place[list(outputs)])

    def _sum(self, terms: Sequence[Term], begin: int) -> int:
        """A row with these terms, whose entries stand in the pool from ``begin`` on."""
        (row,) = self._new(1)
        for source, entry, number in terms:
            self._row.append(row)
            self._column.append(source)
            self._where.append(self._number(-number) if entry is None else begin + entry)
        return row

    def _shared(self, terms: tuple[Term, ...]) -> int:
        """A row of numbers only, as sums of parameters are: the same one for all maps."""
        if terms not in self._known:
            self._known[terms] = self._sum(terms, 0)
        return self._known[terms]

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

    Its diagonal is left out: CasADi's substitution takes a missing entry there for one, and one
    that is present costs a division.

    Parameters
    ----------
    triplets : row, column and place in ``pool`` of every entry below the diagonal
    pool : MX entries, and numbers behind them
    size : of the matrix
    inputs : length of the directions, and those that matter, which are the first rows
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
        width = max(1, min(WIDTH, NEAR // self.size))
        cuts = [*range(0, directions[0].shape[1], width), directions[0].shape[1]]
        few = [
            self._tangent([block[:, begin:end] for block in directions])
            for begin, end in pairwise(cuts)
        ]
        return ca.horzcat(*few)

    def _tangent(self, directions: Sequence[ca.MX]) -> ca.MX:
        begin, given = 0, ca.MX(self.size, directions[0].shape[1])
        for block in directions:
            end = begin + block.shape[0]
            rows = np.flatnonzero((self.used >= begin) & (self.used < end))
            part = block[[int(k) for k in self.used[rows] - begin], :]
            given, begin = given + _placed(part, self.size, rows), end
        return _substituted(self._lower, ca.densify(given))[self.outputs, :]

    def along(self, sizes: Sequence[int]) -> ca.Function:
        """``(entries, direction) → rates`` in scalars, with blocks of these sizes."""
        triplets = self.row, self.column, self.pick
        pool = ca.MX.sym("e", self.entries.numel()), self._numbers
        same = TriangularMap(
            triplets, pool, self.size, (self.input_count, self.used), np.array(self.outputs)
        )
        blocks = [ca.MX.sym(f"d{k}", size) for k, size in enumerate(sizes)]
        return ca.Function("along", [pool[0], *blocks], [same.tangent(blocks)]).expand()

    def adjoint(self, weights: ca.MX) -> ca.MX:
        """Weights (inputs,) of the directions for weights (outputs,) of the rates."""
        given = ca.densify(_placed(weights, self.size, np.array(self.outputs)))
        solved = _substituted(self._matrix(self.column, self.row), given)
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


def _substituted(matrix: ca.MX, given: ca.MX) -> ca.MX:
    """Solution with a triangular matrix whose diagonal of ones is left out."""
    return ca.solve(matrix, given) if matrix.nnz() else given


def _placed(block: ca.MX, rows: int, where: np.ndarray) -> ca.MX:
    """A sparse matrix of so many rows with the rows of the block at increasing places."""
    pattern = ca.Sparsity.dense(*block.shape)
    pattern.enlargeRows(rows, [int(k) for k in where])
    return ca.sparsity_cast(ca.densify(block), pattern)
