"""What evaluates a function of the graph: CasADi's virtual machine, or machine code.

All give the same numbers. A backend is asked for each function that is evaluated again and again,
and answers with what calls it for many columns of arguments.
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
from dalembert.symbolic.native.c_compiler import needed_compiler
from dalembert.symbolic.native.code_cache import made
from dalembert.symbolic.native.llvm import find_llvm, needed_llvm
from dalembert.symbolic.native.source import c_source, hindrance
from dalembert.symbolic.native.toolchain import NotTranslated, Toolchain
from dalembert.symbolic.once import once

MANY = 100
"""Columns from which a mapped function is worth compiling to who asked for it."""


class Backend(ABC):
    """Chooses how functions are evaluated."""

    @once
    def columns(
        self,
        function: ca.Function,
        carried: bool = False,
        fixed: tuple[int, ...] = (),
        called: ca.Function | None = None,
    ) -> Columns:
        """A function for many columns; made once, for chunks ask again and again.

        ``carried`` and ``fixed`` as in ``Columns``; ``called`` is the same function in the form
        that is fastest compiled, if there is another.
        """
        return self._columns(function, carried, fixed, called)

    @property
    def has_lanes(self) -> bool:
        """Whether it computes anything side by side."""
        return False

    def side_by_side(self, function: ca.Function, called: ca.Function, work: int) -> bool:
        """Whether several sets of arguments are to be computed side by side, by LLVM.

        ``work`` columns are asked for of all sets together; ``called`` is what would be compiled.
        """
        return False

    def repays_lanes(self, operations: float, compiled: Sequence[ca.Function]) -> bool:
        """Whether so many operations of the virtual machine are rather done side by side, by LLVM,

        which has to compile these functions.
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
        """Make the columns."""


class VirtualMachine(Backend):
    """CasADi's own interpreter: ready at once, nothing to compile."""

    def _columns(
        self,
        function: ca.Function,
        carried: bool,
        fixed: tuple[int, ...],
        called: ca.Function | None,
    ) -> Columns:
        return VirtualColumns(function, carried, fixed)


class Compiled(Backend):
    """Machine code, compiled once and kept on disk.

    Functions that CasADi cannot write as C, those with SUNDIALS inside, stay on the virtual
    machine, so do those too large to be faster compiled, those that the toolchain cannot translate,
    and those evaluated for few columns only.

    Parameters
    ----------
    needed : gives the toolchain

    Raises
    ------
    UnsupportedError
        When columns are asked for: there is no toolchain, it fails, or the cache cannot be written.
    """

    def __init__(self, needed: Callable[[], Toolchain]):
        self._needed = needed

    @property
    def has_lanes(self) -> bool:
        return self._needed is needed_llvm and find_llvm() is not None

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
            return _WhereMany(function, fixed, partial(self._made, function, False, fixed))
        return self._made(function, carried, fixed)

    def _made(self, function: ca.Function, carried: bool, fixed: tuple[int, ...]) -> Columns:
        toolchain = self._needed()
        text = c_source(function)
        why = hindrance(text, toolchain)
        if text is None or why:
            return VirtualColumns(function, carried, fixed, why)
        try:
            loop = made(text, toolchain)
        except NotTranslated as error:
            return VirtualColumns(function, carried, fixed, str(error))
        return NativeColumns(function, loop, toolchain.name, carried, fixed)


class _WhereMany(Columns):
    """On the virtual machine until many columns are asked for."""

    def __init__(
        self, function: ca.Function, fixed: Sequence[int], compiled: Callable[[], Columns]
    ):
        super().__init__(function, False, fixed)
        self._virtual, self._make = VirtualColumns(function, False, fixed), compiled
        self._many: Columns | None = None

    def __call__(self, count: int, *arguments: Any) -> list[np.ndarray]:
        if self._many is None and count >= MANY:
            self._many = self._make()
        return (self._many or self._virtual)(count, *arguments)

    @property
    def report(self) -> str:
        return (self._many or self._virtual).report

    @property
    def compiled(self) -> bool:
        return self._many is not None and self._many.compiled

    @property
    def pieces(self) -> tuple[int, ...]:
        return () if self._many is None else self._many.pieces


class Automatic(Backend):
    """Machine code where it is in the cache, or where the work repays compiling."""

    @property
    def has_lanes(self) -> bool:
        return find_llvm() is not None

    def side_by_side(self, function: ca.Function, called: ca.Function, work: int) -> bool:
        return self.repays_lanes(work * instructions(function), [called])

    def repays_lanes(self, operations: float, compiled: Sequence[ca.Function]) -> bool:
        return self.has_lanes and repays(operations, compiled)

    def _columns(
        self,
        function: ca.Function,
        carried: bool,
        fixed: tuple[int, ...],
        called: ca.Function | None,
    ) -> Columns:
        toolchain = best_toolchain()
        if toolchain is None:
            why = "neither llvmlite nor a C compiler is installed"
            return VirtualColumns(function, carried, fixed, why)
        return SwitchingColumns(function, toolchain, carried, fixed, called)


BACKENDS: dict[str, Callable[[], Backend]] = {
    "auto": Automatic,
    "vm": VirtualMachine,
    "jit": lambda: Compiled(needed_llvm),
    "c": lambda: Compiled(needed_compiler),
}
"""Name in ``Dynamics`` → what makes the backend."""
