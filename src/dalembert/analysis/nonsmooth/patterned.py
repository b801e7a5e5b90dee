"""Sparse matrices out of compiled functions: a pattern, known once, and its entries."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
from scipy import sparse

from dalembert.symbolic.kernel import Kernel


class Patterned:
    """A function whose outputs are sparse matrices, or columns where they have one.

    Parameters
    ----------
    name : of the function
    inputs, outputs : SX
    """

    def __init__(self, name: str, inputs: Sequence[ca.SX], outputs: Sequence[ca.SX]):
        found = [ca.sparsify(output) for output in outputs]
        self._shapes = [output.shape for output in found]
        self._patterns = [
            (np.array(s.row(), dtype=int), np.array(s.colind(), dtype=int))
            for s in (output.sparsity() for output in found)
        ]
        entries = [ca.densify(ca.vertcat(*output.nonzeros())) for output in found]
        self._call = Kernel(ca.Function(name, list(inputs), entries, {"cse": True}))

    def __call__(self, *arguments) -> list[np.ndarray | sparse.csr_array]:
        """Rows of one column are arrays, everything else compressed by rows."""
        results: list[np.ndarray | sparse.csr_array] = []
        values = self._call(*arguments)
        for value, shape, (row, start) in zip(values, self._shapes, self._patterns, strict=True):
            if shape[1] == 1:
                column = np.zeros(shape[0])
                column[row] = value.ravel()
                results.append(column)
            else:
                matrix = sparse.csc_array((value.ravel(), row, start), shape=shape)
                results.append(sparse.csr_array(matrix))
        return results
