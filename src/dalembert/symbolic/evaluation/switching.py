"""Columns that begin on the virtual machine and go over to machine code.

What is in the cache is taken at once. Work that is announced and takes several times as long as
compiling waits for it. Else it is not known how much is still to come: once the work has taken as
long as compiling, that is done in a process of its own, and the virtual machine goes on until it
has ended. Both give the same numbers, so that nobody sees when they change.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache, partial
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.symbolic.evaluation.columns import (
    Columns,
    NativeColumns,
    VirtualColumns,
    compiled_form,
    instructions,
)
from dalembert.symbolic.native.background import Compilation, possible
from dalembert.symbolic.native.c_compiler import find_compiler
from dalembert.symbolic.native.code_cache import kept, made
from dalembert.symbolic.native.llvm import find_llvm
from dalembert.symbolic.native.source import c_source, hindrance
from dalembert.symbolic.native.toolchain import Call, Toolchain
from dalembert.symbolic.once import once

VIRTUAL_RATE = 2e-9
TEXT_RATE = 4e-6
"""Rough: seconds for an instruction, to evaluate it and to write it as C."""
WORTH_WAITING = 1.5
"""Times the cost of compiling from which announced work waits for it."""
LATEST = 1.0
"""Seconds on the virtual machine after which compiling has begun."""


@lru_cache
def best_toolchain() -> Toolchain | None:
    """LLVM, else a C compiler, else nothing."""
    return find_llvm() or find_compiler()


class SwitchingColumns(Columns):
    """On the virtual machine as long as that is cheaper.

    Parameters
    ----------
    function, carried, fixed : as for all
    toolchain : what compiles
    called : the function in the form that is compiled, if there is another
    """

    def __init__(
        self,
        function: ca.Function,
        toolchain: Toolchain,
        carried: bool = False,
        fixed: Sequence[int] = (),
        called: ca.Function | None = None,
    ):
        super().__init__(function, carried, fixed)
        self._toolchain, self._called = toolchain, compiled_form(function, called)
        self._virtual = VirtualColumns(function, carried, fixed)
        self._native: NativeColumns | None = None
        self._text: str | None = None
        self._compilation: Compilation | None = None
        self._ended = False
        self._announced = 0
        self._seconds = 0.0
        self._columns = 0
        self._instructions = instructions(function)

    def announce(self, count: int) -> None:
        self._announced = count
        if not self._ended:
            self._decide(count)

    def prepare(self, count: int) -> None:
        if self._native is None:
            self._virtual.prepare(count)
        else:  # what is said of this run is not said of the ones before
            self._columns = 0

    @property
    def report(self) -> str:
        """What evaluated the columns."""
        if self._native is None:
            return "VM"
        name = self._toolchain.name
        return f"VM, then {name}" if self._columns else name

    @property
    def compiled(self) -> bool:
        return self._native is not None

    @property
    def pieces(self) -> tuple[int, ...]:
        return () if self._native is None else self._native.pieces

    def __call__(self, count: int, *arguments: Any) -> list[np.ndarray]:
        if not self._ended:
            self._decide(max(count, self._announced))
        if self._native is not None:
            return self._native(count, *arguments)
        begin = time.perf_counter()
        try:
            return self._virtual(count, *arguments)
        finally:
            self._seconds += time.perf_counter() - begin
            self._columns += count
            self._announced = max(0, self._announced - count)

    def _decide(self, ahead: int) -> None:
        """Take what is compiled, or compile it, where the columns so far and ahead repay that."""
        rate = self._seconds / self._columns if self._columns else VIRTUAL_RATE * self._instructions
        coming = ahead * rate
        if self._compilation is not None:
            self._end()
            return
        if self._text is None:
            if self._seconds + coming < TEXT_RATE * self._instructions / 2:
                return
            self._text = c_source(self._called) or ""
            if hindrance(self._text or None, self._toolchain):
                self._ended = True
                return
            self._take(kept(self._text, self._toolchain))
        if not self._ended:
            self._compile(coming)

    def _compile(self, coming: float) -> None:
        least = self._toolchain.least_effort(str(self._text))
        known = coming >= WORTH_WAITING * least and coming >= WORTH_WAITING * self._effort
        if not known and self._seconds + coming < min(least, LATEST):
            return
        if not known and possible():
            self._compilation = Compilation(str(self._text), self._toolchain)
            return
        try:
            self._take(made(str(self._text), self._toolchain))
        except UnsupportedError:  # a run must not fail for what it did not ask for
            self._ended = True

    @cached_property
    def _effort(self) -> float:
        return self._toolchain.effort(str(self._text))

    def _end(self) -> None:
        """Take what another process has compiled, once it has."""
        if self._compilation is not None and not self._compilation.running:
            self._take(kept(str(self._text), self._toolchain))
            self._ended = True

    def _take(self, loop: Call | None) -> None:
        if loop is not None:
            self._native = NativeColumns(
                self._called, loop, self._toolchain.name, self.carried, sorted(self.fixed)
            )
            self._ended = True


def repays(operations: float, compiled: Sequence[ca.Function]) -> bool:
    """Whether so many operations take longer than to compile functions by LLVM."""
    coming = operations * VIRTUAL_RATE
    if find_llvm() is None or coming < TEXT_RATE * sum(map(instructions, compiled)):
        return False
    least, whole = zip(*map(_efforts, compiled), strict=True)
    if coming < WORTH_WAITING * sum(least):
        return False
    return coming >= WORTH_WAITING * sum(effort() for effort in whole)


@once
def _efforts(called: ca.Function) -> tuple[float, Callable[[], float]]:
    """Seconds to compile a function by LLVM: the least, and by a closer look."""
    text, toolchain = c_source(called) or "", find_llvm()
    assert toolchain is not None
    return toolchain.least_effort(text), lru_cache(partial(toolchain.effort, text))
