"""A function of the graph called for many columns of arguments, one after the other.

The loop runs inside CasADi or inside machine code; NumPy converts once.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import SolverFailure
from dalembert.symbolic.evaluation.kernel import NO_SOLUTION, Kernel, flattened
from dalembert.symbolic.native.toolchain import Call


class Columns(ABC):
    """``function`` for many columns.

    Arguments are the columns side by side; results, too. Where an argument of the function is a
    matrix, a column means one such matrix.

    Parameters
    ----------
    function : dense in all inputs
    carried : the first argument is the first result for the column before, and given once
    fixed : numbers of the arguments that are the same for all columns, and given once
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
        """Results for so many columns.

        Raises
        ------
        SolverFailure
            A solver inside the function gives up.
        """

    def announce(self, count: int) -> None:  # noqa: B027, who does not care does nothing
        """So many columns will be asked for, in one call or several."""

    def prepare(self, count: int) -> None:  # noqa: B027
        """Make what a call for so many columns needs."""

    @property
    @abstractmethod
    def report(self) -> str:
        """What evaluates the columns, for people."""

    @property
    def compiled(self) -> bool:
        """They are evaluated by machine code now."""
        return False

    @property
    def pieces(self) -> tuple[int, ...]:
        """Pieces of machine code, and how many of them differ, where that is known."""
        return ()


class VirtualColumns(Columns):
    """By CasADi's virtual machine.

    Parameters
    ----------
    function, carried, fixed : as for all
    why : the reason, where machine code was asked for
    """

    def __init__(
        self,
        function: ca.Function,
        carried: bool = False,
        fixed: Sequence[int] = (),
        why: str = "",
    ):
        super().__init__(function, carried, fixed)
        self._kernels: dict[int, Kernel] = {}
        self._why = why

    @property
    def report(self) -> str:
        return f"VM ({self._why})" if self._why else "VM"

    def __call__(self, count: int, *arguments: Any) -> list[np.ndarray]:
        return self._kernel(count)(*arguments)

    def prepare(self, count: int) -> None:
        self._kernel(count)

    def _kernel(self, count: int) -> Kernel:
        if count not in self._kernels:
            self._kernels[count] = Kernel(self._chunk(count) if count > 1 else self.function)
        return self._kernels[count]

    def _chunk(self, count: int) -> ca.Function:
        """One function for so many columns; what is fixed is repeated inside."""
        f, kind = self.function, ca.MX
        if not self.once:
            return f.map(count)
        shapes = [f.size_in(i) for i in range(f.n_in())]
        widths = [1 if i in self.once else count for i in range(f.n_in())]
        given = [kind.sym(f"i{i}", r, c * widths[i]) for i, (r, c) in enumerate(shapes)]
        seen = [
            ca.repmat(symbol, 1, count) if i in self.fixed else symbol
            for i, symbol in enumerate(given)
        ]
        out = (f.mapaccum(count) if self.carried else f.map(count)).call(seen)
        return ca.Function("chunk", given, [ca.densify(o) for o in out])


class NativeColumns(Columns):
    """By machine code.

    Parameters
    ----------
    function, carried, fixed : as for all
    loop : what it was compiled to
    name : of what compiled it

    Attributes
    ----------
    lanes : numbers in the place of one
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
        given = [
            flattened(self.function.name(), i, argument, size * (1 if i in self.once else count))
            for i, (argument, size) in enumerate(zip(arguments, self.sizes, strict=True))
        ]
        results = [np.empty(rows * columns * count) for rows, columns in self.shapes]
        if self.carried:  # each result is the next argument, where it lies
            first = self.sizes[0]
            whole = np.empty(first * (count + 1))
            whole[:first] = given[0]
            given[0], results[0] = whole, whole[first:]
        done = self._call(count, given, results)
        if done < count:
            self._fail([self._column(i, column, done) for i, column in enumerate(given)])
        return [
            result.reshape((rows, columns * count), order="F")
            for result, (rows, columns) in zip(results, self.shapes, strict=True)
        ]

    @property
    def report(self) -> str:
        return self._name

    @property
    def compiled(self) -> bool:
        return True

    @property
    def pieces(self) -> tuple[int, ...]:
        return getattr(self._loop, "pieces", ())

    def _call(self, count: int, given: list[np.ndarray], results: list[np.ndarray]) -> int:
        """How many columns are done; every call has its own memory, so that threads may call."""
        begins = [
            np.array([a.ctypes.data for a in part], dtype=np.uint64) for part in (given, results)
        ]
        arg, res, iw, w = (np.empty(size, dtype=np.int64) for size in self._work)
        memory = (begins[0], self._steps[0], begins[1], self._steps[1], arg, res, iw, w)
        counts = count, len(given), len(results)
        return self._loop(*counts, *(array.ctypes.data for array in memory))

    def _column(self, i: int, given: np.ndarray, k: int) -> np.ndarray:
        size = self.sizes[i]
        return given if i in self.fixed else given[k * size : (k + 1) * size]

    def _fail(self, arguments: list[np.ndarray]) -> None:
        """Raise what the virtual machine says of the column that failed."""
        with suppress(ValueError):
            Kernel(self.function)(*arguments)
        raise SolverFailure(NO_SOLUTION)


LONG = 6000
"""Operations from which parts that occur several times are compiled once and called: steps of
fewer are compiled quickly, and a tenth faster where nothing is called."""


def compiled_form(function: ca.Function, called: ca.Function | None) -> ca.Function:
    """The form of a function that is compiled."""
    long = called is not None and instructions(function) > LONG
    return dense(called if called is not None and long else function)


def instructions(function: ca.Function) -> int:
    """About how many operations a function does."""
    inside = [function, *function.find_functions()]
    return sum(f.n_instructions() for f in inside if f.is_a("SXFunction") or f.is_a("MXFunction"))


def dense(function: ca.Function) -> ca.Function:
    """The function with dense results."""
    if all(function.sparsity_out(i).is_dense() for i in range(function.n_out())):
        return function
    symbolic = function.is_a("SXFunction")
    given: Any = function.sx_in() if symbolic else function.mx_in()
    out = [ca.densify(result) for result in function.call(given)]
    return ca.Function(function.name(), given, out)
