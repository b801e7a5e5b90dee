"""Graph functions with NumPy arrays as arguments and results.

CasADi's own conversions between NumPy and its matrices cost more per column than a time step, so
arrays are passed as memory.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from io import StringIO
from typing import Any, Literal

import casadi as ca
import numpy as np
import scipy

from dalembert.errors import SolverFailure
from dalembert.symbolic.formulas.expression import stack

CSE_OPERATIONS = 100_000
"""Upper limit of operations for common subexpression elimination."""
SELDOM = 1_000
"""The same for functions evaluated at starts and outputs and for derivatives, not in every step."""


def condensed(
    name: str,
    inputs: list[ca.SX],
    outputs: list[ca.SX],
    most: int | None = None,
    options: dict[str, Any] | None = None,
) -> ca.Function:
    """``inputs → outputs`` with common subexpressions computed once, if eliminating them pays.

    CasADi takes 3 µs per operation for it, and eliminates a tenth to a fifth of them. That is paid
    back by several thousand evaluations; in large models it would dominate the time to the first
    step.

    Parameters
    ----------
    most : upper limit of operations for common subexpression elimination, if it is lower than
        ``CSE_OPERATIONS``
    options : of the function
    """
    plain = ca.Function(name, inputs, outputs, options or {})
    if plain.n_instructions() > min(CSE_OPERATIONS, most or CSE_OPERATIONS):
        return plain
    return ca.Function(name, inputs, outputs, {**(options or {}), "cse": True})


NO_SOLUTION = "its equations have no unique solution"


def flattened(
    name: str, number: int, argument: Any, size: int, order: Literal["F", "C"] = "F"
) -> np.ndarray:
    """An argument as a flat array of ``size`` entries; a single number is broadcast."""
    if type(argument) is np.ndarray and argument.dtype == float and argument.shape == (size,):
        return argument if argument.flags.c_contiguous else argument.copy()
    flat = np.asarray(argument, dtype=float).ravel(order=order)  # contiguous
    if flat.size == 1 and size != 1:
        flat = np.full(size, flat[0])
    if flat.size != size:
        raise ValueError(f"{name}: argument {number} has {flat.size} entries, needs {size}")
    return flat


REUSED = 100_000
"""Upper limit of numbers of arguments and results whose memory remains from call to call."""


class BoundArrays:
    """Arrays from which a function reads its arguments, and into which it writes its results.

    Parameters
    ----------
    function : dense in all inputs and outputs
    """

    def __init__(self, function: ca.Function):
        self.arguments = [np.zeros(function.numel_in(i)) for i in range(function.n_in())]
        self.results = [np.zeros(function.numel_out(i)) for i in range(function.n_out())]
        self._buffer: Any
        self._buffer, self._trigger = function.buffer()
        for i, argument in enumerate(self.arguments):
            self._buffer.set_arg(i, argument.data)
        for i, result in enumerate(self.results):
            self._buffer.set_res(i, memoryview(result.data))

    def evaluate(self) -> None:
        """Evaluate the function once.

        Raises
        ------
        SolverFailure
            A solver inside the function fails.
        """
        shown, sys.stderr = sys.stderr, StringIO()  # CasADi prints all arguments on failure
        try:
            self._trigger()
        except RuntimeError as error:
            raise SolverFailure(str(error).strip().rpartition(": ")[2].rstrip(".")) from None
        finally:
            sys.stderr = shown
        if self._buffer.ret():  # a failure without an exception; the results are zeros
            raise SolverFailure(NO_SOLUTION)


class Kernel:
    """A CasADi function on NumPy arrays.

    Arguments are arrays of the function's shapes (vectors for single columns or rows); scalars
    are broadcast. Results are arrays of the full shape, one per output.

    Parameters
    ----------
    function : dense in all inputs and outputs

    Raises
    ------
    SolverFailure
        By a call: a solver inside the function fails.
    """

    def __init__(self, function: ca.Function):
        self.function, self._name = function, function.name()
        self._shapes = [function.size_out(i) for i in range(function.n_out())]
        self._idle: list[BoundArrays] = []  # that no call uses, neither in another thread
        self._reused = function.nnz_in() + function.nnz_out() <= REUSED

    def __call__(self, *arguments) -> list[np.ndarray]:
        bound = self._idle.pop() if self._idle else BoundArrays(self.function)
        for i, (own, argument) in enumerate(zip(bound.arguments, arguments, strict=True)):
            if isinstance(argument, float) or np.shape(argument) == own.shape:
                own[:] = argument
            else:
                own[:] = flattened(self._name, i, argument, own.size)
        bound.evaluate()
        if not self._reused:
            results = bound.results
        else:
            results = [result.copy() for result in bound.results]
            self._idle.append(bound)
        return [r.reshape(shape, order="F") for r, shape in zip(results, self._shapes, strict=True)]


Matrix = Any
"""A NumPy array, or a SciPy array compressed by rows."""
SMALL = 2500
"""Upper limit of entries of a matrix that is always dense, as handling its pattern costs more."""


class Patterned:
    """A function whose outputs are columns, or matrices that may be sparse.

    Parameters
    ----------
    name : of the function
    inputs, outputs : SX
    """

    def __init__(self, name: str, inputs: Sequence[ca.SX], outputs: Sequence[ca.SX]):
        sparse_outputs = [ca.sparsify(output) for output in outputs]
        self._small = [o.numel() <= SMALL or o.shape[1] == 1 for o in sparse_outputs]
        self._shapes = [output.shape for output in sparse_outputs]
        self._patterns = [_by_rows(output.sparsity()) for output in sparse_outputs]
        symbols = ca.vertcat(*(ca.vec(symbol) for symbol in inputs))
        self._fixed = [not ca.depends_on(ca.vec(o), symbols) for o in sparse_outputs]
        self._constants: dict[int, Matrix] = {}
        entries = [
            ca.densify(output) if small else ca.densify(stack(output.nonzeros()))  # type: ignore[arg-type]
            for output, small in zip(sparse_outputs, self._small, strict=True)
        ]
        self._call = Kernel(ca.Function(name, list(inputs), entries, {"cse": True}))

    def __call__(self, *arguments) -> list[Matrix]:
        """Columns as vectors; sparse matrices compressed by rows."""
        return [self._matrix(k, value) for k, value in enumerate(self._call(*arguments))]

    def _matrix(self, k: int, value: np.ndarray) -> Matrix:
        shape = self._shapes[k]
        if self._small[k]:
            return value.ravel() if shape[1] == 1 else value
        if k in self._constants:
            return self._constants[k]
        order, column, start = self._patterns[k]
        matrix = scipy.sparse.csr_array((value.ravel()[order], column, start), shape=shape)
        if self._fixed[k]:
            self._constants[k] = matrix
        return matrix


def _by_rows(pattern: ca.Sparsity) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Order of the entries of a pattern by rows, their columns, and the first entry of each row."""
    row = np.array(pattern.row(), dtype=np.int32)
    starts = np.array(pattern.colind(), dtype=np.int32)
    column = np.repeat(np.arange(pattern.size2(), dtype=np.int32), starts[1:] - starts[:-1])
    order = np.argsort(row, kind="stable")
    start = np.searchsorted(row[order], np.arange(pattern.size1() + 1)).astype(np.int32)
    return order, column[order], start


def dense_array(matrix: Matrix) -> np.ndarray:
    """The matrix as a dense array."""
    return matrix.toarray() if scipy.sparse.issparse(matrix) else np.asarray(matrix)
