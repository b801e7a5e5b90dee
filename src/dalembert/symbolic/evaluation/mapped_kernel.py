"""Functions of columns, evaluated for any number of columns at once."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from dalembert.symbolic.evaluation.kernel import BoundArrays

SMALLEST = 16
"""Number of columns of the smallest mapped function; larger ones have 2, 4, 8 … times as many."""


class MappedKernel:
    """A function mapped over columns, for numbers of columns that change from call to call.

    Parameters
    ----------
    function : of columns, dense in all inputs and outputs
    common : numbers of the inputs whose columns are the same in all evaluations
    """

    def __init__(self, function: ca.Function, common: Sequence[int] = ()):
        self.function, self._common = function, list(common)
        self._shapes = [function.size_out(i) for i in range(function.n_out())]
        self._idle: dict[int, list[BoundArrays]] = {}  # that no call uses

    def __call__(self, *columns: np.ndarray | list[np.ndarray]) -> list[np.ndarray]:
        """(n, r, c) results of each output (r, c), for n columns (m, n) of each input.

        Columns may be lists of blocks (m, n) of their rows. The first input is none of the common
        ones, which are (m,).
        """
        first = columns[0]
        count = (first[0] if isinstance(first, list) else first).shape[1]
        size = SMALLEST
        while size < count:
            size *= 2
        idle = self._idle.setdefault(size, [])
        bound = idle.pop() if idle else BoundArrays(self._mapped(size))
        for i, (own, argument) in enumerate(zip(bound.arguments, columns, strict=True)):
            if i in self._common:
                own[:] = argument
                continue
            used = own.reshape(size, -1)[:count]  # the rest is of earlier calls
            begin = 0
            for block in argument if isinstance(argument, list) else [argument]:
                used[:, begin : begin + block.shape[0]] = block.T
                begin += block.shape[0]
        bound.evaluate()
        results = [
            result.reshape(size, c, r)[:count].copy().swapaxes(1, 2)
            for result, (r, c) in zip(bound.results, self._shapes, strict=True)
        ]
        idle.append(bound)
        return results

    def _mapped(self, size: int) -> ca.Function:
        return self.function.map(f"mapped{size}", "serial", size, self._common, [])
