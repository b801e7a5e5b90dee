"""Functions with sparse derivatives by the variables of a step.

The columns of derivatives are ``q = (y, v, t, p)``: positions, speeds, time, parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np
import scipy

from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.formulas.expression import stack

Sparse = Any
"""A SciPy array compressed by rows."""


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
            pattern.matrix(ca.DM(part).full().ravel()) if same else None
            for pattern, part, same in zip(self._patterns, entries, fixed, strict=True)
        ]
        self._call = Kernel(ca.Function(name, list(inputs), outputs, {"cse": True}))

    def __call__(self, *arguments) -> tuple[np.ndarray, list[Sparse]]:
        """The value, and its derivatives compressed by rows."""
        value, *entries = self._call(*arguments)
        varying = iter(entries)
        return value.ravel(), [
            pattern.matrix(next(varying).ravel()) if fixed is None else fixed
            for pattern, fixed in zip(self._patterns, self._fixed, strict=True)
        ]


class _Pattern:
    """Positions of nonzero entries, converted from columns to rows."""

    def __init__(self, sparsity: ca.Sparsity):
        row, start = np.array(sparsity.row(), dtype=np.int32), np.array(sparsity.colind())
        column = np.repeat(np.arange(sparsity.size2(), dtype=np.int32), np.diff(start))
        self._order = np.lexsort((column, row))
        self._columns, self._shape = column[self._order], sparsity.shape
        counts = np.bincount(row, minlength=sparsity.size1())
        self._starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)

    def matrix(self, entries: np.ndarray) -> Sparse:
        parts = entries[self._order], self._columns, self._starts
        return scipy.sparse.csr_array(parts, shape=self._shape)
