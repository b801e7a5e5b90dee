"""Functions with sparse derivatives by the variables of a step, for one or many steps.

The columns of derivatives are ``q = (y, v, t, p)``: positions, speeds, time, parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np
import scipy

from dalembert.sensitivity.nonsmooth.triplets import Sparse, Triplets
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.formulas.expression import stack


class SlopeFunction:
    """``inputs → value, derivatives``.

    Parameters
    ----------
    name : of the function
    inputs : SX symbols
    value : SX (m,)
    by : columns of each derivative
    """

    def __init__(self, name: str, inputs: Sequence[ca.SX], value: ca.SX, by: Sequence[ca.SX]):
        slopes = [ca.sparsify(ca.jacobian(value, columns)) for columns in by]
        entries = [ca.densify(stack(slope.nonzeros())) for slope in slopes]  # type: ignore[arg-type]
        fixed = [not ca.symvar(part) for part in entries]
        outputs = [
            ca.densify(value),
            *(e for e, same in zip(entries, fixed, strict=True) if not same),
        ]
        self._patterns = [_Pattern(slope.sparsity()) for slope in slopes]
        self._fixed = [
            ca.DM(part).full().reshape(-1, 1) if same else None
            for part, same in zip(entries, fixed, strict=True)
        ]
        self._function = ca.Function(name, list(inputs), outputs, {"cse": True})
        self._calls = {1: Kernel(self._function)}

    def rows(self, number: int) -> np.ndarray:
        """(m,) mask of the entries of the value that a derivative may change."""
        return self._patterns[number].rows

    def __call__(self, *arguments, count: int | None = None) -> tuple[np.ndarray, list[Sparse]]:
        """The value, and its derivatives: compressed by rows, or triplets without ``count``.

        Parameters
        ----------
        *arguments : matrices of ``count`` columns, or numbers and vectors of all columns
        count : number of columns, whose values follow one another and whose derivatives are
            diagonal blocks; numbers and vectors alone by default
        """
        number = count or 1
        value, *entries = (part[:, :number] for part in self._columns(arguments, number))
        varying, slopes = iter(entries), []
        for pattern, fixed in zip(self._patterns, self._fixed, strict=True):
            own = np.repeat(fixed, number, axis=1) if fixed is not None else next(varying)
            slopes.append(pattern.matrix(own) if count else pattern.triplets(own[:, 0]))
        return value.T.ravel(), slopes

    def _columns(self, arguments: Sequence[Any], count: int) -> list[np.ndarray]:
        """Outputs for all columns, which are repeated up to a power of two."""
        if count == 1:
            return self._calls[1](*arguments)
        size = 1 << (count - 1).bit_length()
        if size not in self._calls:
            self._calls[size] = Kernel(self._function.map(size))
        place, columns = np.arange(size) % count, []
        for argument in map(np.asarray, arguments):
            each = argument.ndim == 2
            columns.append(argument[:, place] if each else np.tile(argument.reshape(-1, 1), size))
        return self._calls[size](*columns)


class _Pattern:
    """Positions of nonzero entries, converted from columns to rows.

    Attributes
    ----------
    rows : (m,) mask of the rows with entries
    """

    def __init__(self, sparsity: ca.Sparsity):
        row, start = np.array(sparsity.row(), dtype=np.int32), np.array(sparsity.colind())
        column = np.repeat(np.arange(sparsity.size2(), dtype=np.int32), np.diff(start))
        self._order = np.lexsort((column, row))
        self._columns, self._shape = column[self._order], sparsity.shape
        self._rows = row[self._order]
        counts = np.bincount(row, minlength=sparsity.size1())
        self.rows = counts > 0
        self._starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)

    def triplets(self, entries: np.ndarray) -> Triplets:
        """The matrix with some entries."""
        return Triplets(self._rows, self._columns, entries[self._order], self._shape)

    def matrix(self, entries: np.ndarray) -> Sparse:
        """Diagonal blocks of the columns of ``entries``."""
        size, count = entries.shape
        block, (rows, columns) = np.arange(count, dtype=np.int32)[:, None], self._shape
        place = (self._columns + columns * block).ravel()
        starts = np.append((self._starts[:-1] + size * block).ravel(), size * count)
        parts = entries[self._order].T.ravel(), place, starts.astype(np.int32)
        return scipy.sparse.csr_array(parts, shape=(rows * count, columns * count))
