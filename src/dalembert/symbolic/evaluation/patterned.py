"""Matrices out of compiled functions: small ones dense, others by a pattern that is known once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np
import scipy

from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.formulas.expression import stack

Matrix = Any
"""A NumPy array, or one of SciPy's compressed by rows."""
SMALL = 2500
"""Entries of a matrix that is dense in any case: handling a pattern costs more."""


class Patterned:
    """A function whose outputs are columns, or matrices that may be sparse.

    Parameters
    ----------
    name : of the function
    inputs, outputs : SX
    """

    def __init__(self, name: str, inputs: Sequence[ca.SX], outputs: Sequence[ca.SX]):
        found = [ca.sparsify(output) for output in outputs]
        self._small = [o.numel() <= SMALL or o.shape[1] == 1 for o in found]
        self._shapes = [output.shape for output in found]
        self._patterns = [
            (np.array(s.row(), dtype=int), np.array(s.colind(), dtype=int))
            for s in (output.sparsity() for output in found)
        ]
        entries = [
            ca.densify(output) if small else ca.densify(stack(output.nonzeros()))  # type: ignore[arg-type]
            for output, small in zip(found, self._small, strict=True)
        ]
        self._call = Kernel(ca.Function(name, list(inputs), entries, {"cse": True}))

    def __call__(self, *arguments) -> list[Matrix]:
        """Columns as vectors; sparse matrices by rows."""
        return [self._made(k, value) for k, value in enumerate(self._call(*arguments))]

    def _made(self, k: int, value: np.ndarray) -> Matrix:
        shape = self._shapes[k]
        if self._small[k]:
            return value.ravel() if shape[1] == 1 else value
        row, start = self._patterns[k]
        return scipy.sparse.csr_array(
            scipy.sparse.csc_array((value.ravel(), row, start), shape=shape)
        )


def dense(matrix: Matrix) -> np.ndarray:
    """All entries."""
    return matrix.toarray() if scipy.sparse.issparse(matrix) else np.asarray(matrix)
