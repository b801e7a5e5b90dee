"""Functions of columns, evaluated for many columns in blocks that fit into the cache."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.symbolic.evaluation.kernel import Kernel

SMALLEST, LARGEST = 16, 512
"""Numbers of columns of the smallest and the largest mapped function; those between have 2, 4, 8 …
times as many as the smallest."""


class BlockedKernel:
    """A function of columns.

    Parameters
    ----------
    function : dense in all inputs and outputs
    """

    def __init__(self, function: ca.Function):
        self._function = function
        self._kernels: dict[int, Kernel] = {}

    def __call__(self, *columns: np.ndarray) -> list[np.ndarray]:
        """(n, r, c) results of each output (r, c), for n rows (n, m) of each input."""
        count = columns[0].shape[0]
        size = min(SMALLEST << max(0, int(np.ceil(np.log2(count / SMALLEST)))), LARGEST)
        if size not in self._kernels:
            self._kernels[size] = Kernel(self._function.map(size))
        kernel, begins = self._kernels[size], range(0, count, size)
        parts = [kernel(*(_rows(column, begin, size) for column in columns)) for begin in begins]
        results = []
        for outputs in zip(*parts, strict=True):
            rows = outputs[0].shape[0]
            joined = np.concatenate([part.T.reshape(size, -1, rows) for part in outputs])
            results.append(joined[:count].swapaxes(1, 2))
        return results


def _rows(column: np.ndarray, begin: int, size: int) -> np.ndarray:
    """(m, size) transposed rows from ``begin`` on; the last ones are repeated at the end."""
    rows = column[begin : begin + size]
    if rows.shape[0] < size:
        rows = rows[np.arange(size) % rows.shape[0]]
    return rows.T
