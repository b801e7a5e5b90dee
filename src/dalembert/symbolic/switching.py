"""Columns that begin on the virtual machine and go over to machine code.

Compiling pays where the work on the virtual machine, done and announced, is more than it costs.
Then it is begun in a process of its own, and what is in the cache is taken at once. Both give the
same numbers, so that nobody sees when that happens.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.symbolic.columns import Columns, NativeColumns, VirtualColumns
from dalembert.symbolic.native.background import Compilation
from dalembert.symbolic.native.c_compiler import find_compiler
from dalembert.symbolic.native.library import kept, made
from dalembert.symbolic.native.llvm import find_llvm
from dalembert.symbolic.native.source import c_source, hindrance
from dalembert.symbolic.native.toolchain import Call, Toolchain

VIRTUAL_RATE = 2e-9
TEXT_RATE = 4e-6
"""Rough: seconds for an instruction, to evaluate it and to write it as C."""
COMPILE_RATES = {"LLVM": (0.05, 2e-6), "C": (0.1, 5e-6)}
"""Rough: seconds to begin, and for a character of C."""
AT_ONCE = 0.1
"""Seconds of compiling for which no other process is begun."""
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
    """

    def __init__(
        self,
        function: ca.Function,
        toolchain: Toolchain,
        carried: bool = False,
        fixed: Sequence[int] = (),
    ):
        super().__init__(function, carried, fixed)
        self._toolchain = toolchain
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
        """Take what is compiled, or begin to compile, where the columns so far and ahead pay it."""
        rate = self._seconds / self._columns if self._columns else VIRTUAL_RATE * self._instructions
        work = self._seconds + ahead * rate
        if self._text is None:
            if work < TEXT_RATE * self._instructions / 2:
                return
            self._text = c_source(self.function)
            if self._text is None or hindrance(self._text):
                self._ended = True
                return
            self._take(kept(self._text, self._toolchain))
        elif self._compilation is not None and not self._compilation.running:
            self._take(kept(self._text, self._toolchain))
            self._ended = True
        if self._native is None and self._compilation is None:
            self._begin(work)

    def _begin(self, work: float) -> None:
        fixed, rate = COMPILE_RATES[self._toolchain.name]
        assert self._text is not None
        cost = fixed + rate * len(self._text)
        if work < min(cost, LATEST):
            return
        if cost > AT_ONCE:
            self._compilation = Compilation(self._text, self._toolchain)
            return
        try:
            self._take(made(self._text, self._toolchain))
        except UnsupportedError:  # a run must not fail for what it did not ask for
            self._ended = True

    def _take(self, loop: Call | None) -> None:
        if loop is not None:
            self._native = NativeColumns(
                self.function, loop, self._toolchain.name, self.carried, sorted(self.fixed)
            )
            self._ended = True


def instructions(function: ca.Function) -> int:
    """About how many operations a function does."""
    inside = [function, *function.find_functions()]
    return sum(f.n_instructions() for f in inside if f.is_a("SXFunction") or f.is_a("MXFunction"))
