"""Calling a compiled graph from NumPy without converting a number twice.

CasADi's own conversions between NumPy and its matrices cost more per column than a time step, so
arrays are handed over as memory.
"""

from __future__ import annotations

from contextlib import redirect_stderr
from io import StringIO
from typing import Any, Literal

import casadi as ca
import numpy as np

from dalembert.errors import SolverFailure

NO_SOLUTION = "its equations have no unique solution"


def flattened(
    name: str, number: int, argument: Any, size: int, order: Literal["F", "C"] = "F"
) -> np.ndarray:
    """An argument column by column; a single number fills it."""
    flat = np.ascontiguousarray(np.asarray(argument, dtype=float).ravel(order=order))
    if flat.size == 1 and size != 1:
        flat = np.full(size, flat[0])
    if flat.size != size:
        raise ValueError(f"{name}: argument {number} has {flat.size} entries, needs {size}")
    return flat


class Kernel:
    """A CasADi function on NumPy arrays.

    Arguments are arrays of the function's shapes (vectors for single columns or rows); scalars
    fill their argument. Results are arrays of the full shape, one per output.

    Parameters
    ----------
    function : dense in all inputs and outputs

    Raises
    ------
    SolverFailure
        On a call: a solver inside the function gives up.
    """

    def __init__(self, function: ca.Function):
        self.function = function
        self._sizes = [function.numel_in(i) for i in range(function.n_in())]
        self._shapes = [function.size_out(i) for i in range(function.n_out())]

    def __call__(self, *arguments) -> list[np.ndarray]:
        buffer: Any
        buffer, trigger = self.function.buffer()
        kept = []
        for i, (argument, size) in enumerate(zip(arguments, self._sizes, strict=True)):
            flat = flattened(self.function.name(), i, argument, size)
            kept.append(flat)
            buffer.set_arg(i, memoryview(flat.data))
        results = [np.zeros(rows * columns) for rows, columns in self._shapes]
        for i, result in enumerate(results):
            buffer.set_res(i, memoryview(result.data))
        try:
            with redirect_stderr(StringIO()):  # CasADi prints all arguments of what fails
                trigger()
        except RuntimeError as error:
            raise SolverFailure(str(error).strip().rpartition(": ")[2].rstrip(".")) from None
        if buffer.ret():  # tells what raises nothing; the results are zeros then
            raise SolverFailure(NO_SOLUTION)
        return [r.reshape(shape, order="F") for r, shape in zip(results, self._shapes, strict=True)]
