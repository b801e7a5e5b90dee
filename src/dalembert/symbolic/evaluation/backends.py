"""Backends: CasADi's virtual machine, or machine code.

All return the same numbers. A backend turns a function that is evaluated repeatedly into
``Columns``, which evaluate it for many columns of arguments.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import casadi as ca
import numpy as np

from dalembert.symbolic.evaluation.columns import (
    Columns,
    NativeColumns,
    VirtualColumns,
    compiled_form,
    instructions,
)
from dalembert.symbolic.evaluation.switching import SwitchingColumns, best_toolchain, repays
from dalembert.symbolic.native.c_compiler import require_compiler
from dalembert.symbolic.native.code_cache import compiled_loop
from dalembert.symbolic.native.llvm import find_llvm, require_llvm
from dalembert.symbolic.native.source import c_source, obstacle
from dalembert.symbolic.native.toolchain import NotTranslated, Toolchain
from dalembert.symbolic.once import CacheOwner, once

COMPILE_COLUMNS = 100
"""Threshold for compiling a mapped function: number of columns."""


class Backend(CacheOwner, ABC):
    """Strategy for the evaluation of functions."""

    @once
    def columns(
        self,
        function: ca.Function,
        carried: bool = False,
        fixed: tuple[int, ...] = (),
        called: ca.Function | None = None,
    ) -> Columns:
        """A function for many columns; cached, as chunks request it repeatedly.

        ``carried`` and ``fixed`` as in ``Columns``; ``called`` is an equal function in the form
        that runs fastest when compiled, if there is one.
        """
        return self._columns(function, carried, fixed, called)

    @property
    def has_lanes(self) -> bool:
        """Whether it can evaluate several sets of arguments in lanes."""
        return False

    def side_by_side(self, function: ca.Function, called: ca.Function, work: int) -> bool:
        """Whether to evaluate several sets of arguments in lanes, by LLVM.

        ``work`` is the number of columns of all sets; ``called`` the function to compile.
        """
        return False

    def repays_lanes(self, operations: float, compiled: Sequence[ca.Function]) -> bool:
        """Whether lanes are worth compiling ``compiled`` by LLVM.

        ``operations`` is the number of instructions that the virtual machine would execute.
        """
        return self.has_lanes

    @abstractmethod
    def _columns(
        self,
        function: ca.Function,
        carried: bool,
        fixed: tuple[int, ...],
        called: ca.Function | None,
    ) -> Columns:
        """Create the columns."""


class VirtualMachine(Backend):
    """CasADi's interpreter, which needs no compilation."""

    def _columns(
        self,
        function: ca.Function,
        carried: bool,
        fixed: tuple[int, ...],
        called: ca.Function | None,
    ) -> Columns:
        return VirtualColumns(function, carried, fixed)


class Compiled(Backend):
    """Machine code, compiled once and cached on disk.

    The virtual machine evaluates functions that CasADi cannot write as C (SUNDIALS), functions too
    large to benefit, functions that the toolchain cannot translate, and functions evaluated for
    few columns only.

    Parameters
    ----------
    require : returns the toolchain

    Raises
    ------
    UnsupportedError
        By ``columns``: no toolchain, a toolchain that fails, or a cache that is not writable.
    """

    def __init__(self, require: Callable[[], Toolchain]):
        self._require = require

    @property
    def has_lanes(self) -> bool:
        return self._require is require_llvm and find_llvm() is not None

    def side_by_side(self, function: ca.Function, called: ca.Function, work: int) -> bool:
        return self.has_lanes

    def _columns(
        self,
        function: ca.Function,
        carried: bool,
        fixed: tuple[int, ...],
        called: ca.Function | None,
    ) -> Columns:
        function = compiled_form(function, called)
        if not carried:
            return _LazyColumns(function, fixed, partial(self._compile, function, False, fixed))
        return self._compile(function, carried, fixed)

    def _compile(self, function: ca.Function, carried: bool, fixed: tuple[int, ...]) -> Columns:
        toolchain = self._require()
        text = c_source(function)
        reason = obstacle(text, toolchain)
        if text is None or reason:
            return VirtualColumns(function, carried, fixed, reason)
        try:
            loop = compiled_loop(text, toolchain)
        except NotTranslated as error:
            return VirtualColumns(function, carried, fixed, str(error))
        return NativeColumns(function, loop, toolchain.name, carried, fixed)


class _LazyColumns(Columns):
    """Columns of the virtual machine, compiled at the first call with many columns."""

    def __init__(
        self, function: ca.Function, fixed: Sequence[int], compile_columns: Callable[[], Columns]
    ):
        super().__init__(function, False, fixed)
        self._virtual, self._compile = VirtualColumns(function, False, fixed), compile_columns
        self._native: Columns | None = None

    def __call__(self, count: int, *arguments: Any) -> list[np.ndarray]:
        if self._native is None and count >= COMPILE_COLUMNS:
            self._native = self._compile()
        return (self._native or self._virtual)(count, *arguments)

    @property
    def report(self) -> str:
        return (self._native or self._virtual).report

    @property
    def compiled(self) -> bool:
        return self._native is not None and self._native.compiled

    @property
    def pieces(self) -> tuple[int, ...]:
        return () if self._native is None else self._native.pieces


class Automatic(Backend):
    """Machine code if it is cached, or if the run is long enough to benefit."""

    @property
    def has_lanes(self) -> bool:
        return find_llvm() is not None

    def side_by_side(self, function: ca.Function, called: ca.Function, work: int) -> bool:
        return self.repays_lanes(work * instructions(function), [called])

    def repays_lanes(self, operations: float, compiled: Sequence[ca.Function]) -> bool:
        return self.has_lanes and repays(self, operations, compiled)

    def _columns(
        self,
        function: ca.Function,
        carried: bool,
        fixed: tuple[int, ...],
        called: ca.Function | None,
    ) -> Columns:
        toolchain = best_toolchain()
        if toolchain is None:
            reason = "neither llvmlite nor a C compiler is installed"
            return VirtualColumns(function, carried, fixed, reason)
        return SwitchingColumns(function, toolchain, carried, fixed, called)


BACKENDS: dict[str, Callable[[], Backend]] = {
    "auto": Automatic,
    "vm": VirtualMachine,
    "jit": lambda: Compiled(require_llvm),
    "c": lambda: Compiled(require_compiler),
}
"""Name in ``Dynamics`` → constructor of the backend."""
