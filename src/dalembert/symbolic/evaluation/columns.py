"""Evaluation of a graph function for many columns of arguments in sequence.

The loop runs inside CasADi or inside machine code; NumPy converts once.
"""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import SolverFailure
from dalembert.symbolic.evaluation.kernel import NO_SOLUTION, Kernel, flattened
from dalembert.symbolic.native.toolchain import Call

BASE = 4
"""Copies per level of a nested loop that carries a state; with CasADi's 10 a thousand columns take
several times as long to prepare."""


class Columns(ABC):
    """``function`` for many columns.

    Columns of arguments and results are stacked horizontally. For an argument that is a matrix, a
    column means one such matrix.

    Parameters
    ----------
    function : dense in all inputs
    carried : whether the first argument is the first result for the previous column; passed once
    fixed : indices of the arguments that are equal for all columns; passed once
    """

    def __init__(self, function: ca.Function, carried: bool = False, fixed: Sequence[int] = ()):
        function = dense(function)
        self.function, self.carried, self.fixed = function, carried, frozenset(fixed)
        self.once = self.fixed | ({0} if carried else set())
        if not all(function.sparsity_in(i).is_dense() for i in range(function.n_in())):
            raise ValueError(f"{function.name()}: an argument is sparse")
        self.sizes = [function.numel_in(i) for i in range(function.n_in())]
        self.shapes = [function.size_out(i) for i in range(function.n_out())]

    @abstractmethod
    def __call__(self, count: int, *arguments: Any) -> list[np.ndarray]:
        """Results for ``count`` columns.

        Raises
        ------
        SolverFailure
            A solver inside the function fails.
        """

    def announce(self, count: int) -> None:  # noqa: B027, optional hook
        """Announce the number of columns of the coming calls together."""

    def prepare(self, count: int) -> None:  # noqa: B027
        """Create in advance what a call for ``count`` columns needs."""

    @property
    @abstractmethod
    def report(self) -> str:
        """Name of the evaluator, for output."""

    @property
    def compiled(self) -> bool:
        """Whether machine code evaluates the columns now."""
        return False

    @property
    def pieces(self) -> tuple[int, ...]:
        """Numbers of pieces and of distinct pieces of machine code, if known."""
        return ()


class VirtualColumns(Columns):
    """Evaluation by CasADi's virtual machine.

    Parameters
    ----------
    function, carried, fixed : as in ``Columns``
    reason : why machine code was requested but is not used
    """

    def __init__(
        self,
        function: ca.Function,
        carried: bool = False,
        fixed: Sequence[int] = (),
        reason: str = "",
    ):
        super().__init__(function, carried, fixed)
        self._kernels: dict[int, Kernel] = {}
        self._reason = reason

    @property
    def report(self) -> str:
        return f"VM ({self._reason})" if self._reason else "VM"

    def __call__(self, count: int, *arguments: Any) -> list[np.ndarray]:
        return self._kernel(count)(*arguments)

    def prepare(self, count: int) -> None:
        self._kernel(count)

    def _kernel(self, count: int) -> Kernel:
        if count not in self._kernels:
            self._kernels[count] = Kernel(self._chunk(count) if count > 1 else self.function)
        return self._kernels[count]

    def _chunk(self, count: int) -> ca.Function:
        """One function for ``count`` columns; fixed arguments are repeated inside."""
        f = self.function
        if not self.once:
            return f.map(count)
        shapes = [f.size_in(i) for i in range(f.n_in())]
        widths = [1 if i in self.once else count for i in range(f.n_in())]
        inputs = [ca.MX.sym(f"i{i}", r, c * widths[i]) for i, (r, c) in enumerate(shapes)]
        repeated = [
            ca.repmat(symbol, 1, count) if i in self.fixed else symbol
            for i, symbol in enumerate(inputs)
        ]
        mapped = f.mapaccum("chunk", count, {"base": BASE}) if self.carried else f.map(count)
        out = mapped.call(repeated)
        return ca.Function("chunk", inputs, [ca.densify(o) for o in out])


class NativeColumns(Columns):
    """Evaluation by machine code.

    Parameters
    ----------
    function, carried, fixed : as in ``Columns``
    loop : compiled loop over columns
    name : of the toolchain

    Attributes
    ----------
    lanes : sets of arguments evaluated side by side
    """

    lanes = 1

    def __init__(
        self,
        function: ca.Function,
        loop: Call,
        name: str,
        carried: bool = False,
        fixed: Sequence[int] = (),
    ):
        super().__init__(function, carried, fixed)
        self._name = name
        self._loop = loop
        steps = [0 if i in self.fixed else size for i, size in enumerate(self.sizes)]
        self._steps = (
            np.array(steps, dtype=np.int64),
            np.array([rows * columns for rows, columns in self.shapes], dtype=np.int64),
        )
        f = self.function
        self._work = (
            f.sz_arg() + f.n_in(),
            f.sz_res() + f.n_out(),
            f.sz_iw() + 1,
            f.sz_w() * self.lanes + 1,
        )

    def __call__(self, count: int, *arguments: Any) -> list[np.ndarray]:
        buffers = [
            flattened(self.function.name(), i, argument, size * (1 if i in self.once else count))
            for i, (argument, size) in enumerate(zip(arguments, self.sizes, strict=True))
        ]
        results = [np.empty(rows * columns * count) for rows, columns in self.shapes]
        if self.carried:  # each result is the next argument, in place
            first = self.sizes[0]
            states = np.empty(first * (count + 1))
            states[:first] = buffers[0]
            buffers[0], results[0] = states, states[first:]
        done = self._call(count, buffers, results)
        if done < count:
            self._fail([self._column(i, column, done) for i, column in enumerate(buffers)])
        return [
            result.reshape((rows, columns * count), order="F")
            for result, (rows, columns) in zip(results, self.shapes, strict=True)
        ]

    def bound(
        self, count: int, arguments: Sequence[np.ndarray], results: Sequence[np.ndarray]
    ) -> BoundCall:
        """The loop on arrays of the caller, who writes arguments and reads results in place."""
        return BoundCall(self._loop, self._memory(count, [*arguments], [*results]))

    @property
    def report(self) -> str:
        return self._name

    @property
    def compiled(self) -> bool:
        return True

    @property
    def pieces(self) -> tuple[int, ...]:
        return getattr(self._loop, "pieces", ())

    def _call(self, count: int, buffers: list[np.ndarray], results: list[np.ndarray]) -> int:
        """Number of completed columns; each call has its own memory and is thread-safe."""
        counts, memory = self._memory(count, buffers, results)
        return self._loop(*counts, *(array.ctypes.data for array in memory[:8]))

    def _memory(
        self, count: int, buffers: list[np.ndarray], results: list[np.ndarray]
    ) -> tuple[tuple[int, int, int], list[np.ndarray]]:
        """Counts and arrays of a call, followed by arrays that must exist as long."""
        addresses = [
            np.array([a.ctypes.data for a in arrays], dtype=np.uint64)
            for arrays in (buffers, results)
        ]
        arg, res, iw, w = (np.empty(size, dtype=np.int64) for size in self._work)
        memory = [addresses[0], self._steps[0], addresses[1], self._steps[1], arg, res, iw, w]
        return (count, len(buffers), len(results)), [*memory, *buffers, *results]

    def _column(self, i: int, buffer: np.ndarray, k: int) -> np.ndarray:
        size = self.sizes[i]
        return buffer if i in self.fixed else buffer[k * size : (k + 1) * size]

    def _fail(self, arguments: list[np.ndarray]) -> None:
        """Raise the error of the virtual machine for the column that failed."""
        with suppress(ValueError):
            Kernel(self.function)(*arguments)
        raise SolverFailure(NO_SOLUTION)


class BoundCall(partial[int]):
    """Loop of machine code on fixed arrays, without conversions: ``call() → completed columns``.

    Parameters
    ----------
    loop : machine code
    memory : counts and arrays
    """

    owners: tuple[Call, list[np.ndarray]]
    """Machine code and arrays that the call uses."""

    def __new__(cls, loop: Call, memory: tuple[tuple[int, int, int], list[np.ndarray]]) -> Any:
        counts, arrays = memory
        numbers = [ctypes.c_longlong(count) for count in counts]
        addresses = [ctypes.c_void_p(array.ctypes.data) for array in arrays[:8]]
        call = super().__new__(cls, getattr(loop, "entry", loop), *numbers, *addresses)
        call.owners = (loop, arrays)
        return call


LONG = 6000
"""Operations above which repeated parts are compiled once and called; shorter steps compile quickly
and run a tenth faster without calls."""


def compiled_form(function: ca.Function, called: ca.Function | None) -> ca.Function:
    """The function to compile: the form with calls if it is long."""
    long = called is not None and instructions(function) > LONG
    return dense(called if called is not None and long else function)


def instructions(function: ca.Function) -> int:
    """Approximate number of operations of a function."""
    functions = [function, *function.find_functions()]
    return sum(
        f.n_instructions() for f in functions if f.is_a("SXFunction") or f.is_a("MXFunction")
    )


def dense(function: ca.Function) -> ca.Function:
    """The function with dense results."""
    if all(function.sparsity_out(i).is_dense() for i in range(function.n_out())):
        return function
    symbolic = function.is_a("SXFunction")
    inputs: Any = function.sx_in() if symbolic else function.mx_in()
    out = [ca.densify(result) for result in function.call(inputs)]
    return ca.Function(function.name(), inputs, out)
