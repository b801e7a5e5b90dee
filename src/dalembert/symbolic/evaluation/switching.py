"""Columns that start on the virtual machine and switch to machine code.

Cached machine code is used immediately. Announced work that takes several times as long as
compiling waits for the compilation. Otherwise, once the work has taken as long as compiling, a
separate process compiles, and the virtual machine continues until it has finished. Both return the
same numbers, so the switch does not affect results.
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
from dalembert.symbolic.native.code_cache import cached_loop, compiled_loop
from dalembert.symbolic.native.llvm import find_llvm
from dalembert.symbolic.native.source import c_source, obstacle
from dalembert.symbolic.native.toolchain import Call, Toolchain
from dalembert.symbolic.once import CacheOwner, once

VIRTUAL_RATE = 2e-9
TEXT_RATE = 4e-6
"""Estimated cost per instruction: evaluation, C generation [s]."""
WORTH_WAITING = 1.5
"""Threshold for waiting: ratio of announced work to the cost of compiling."""
LATEST = 1.0
"""Upper limit of the time on the virtual machine before compiling starts [s]."""


@lru_cache
def best_toolchain() -> Toolchain | None:
    """LLVM, else a C compiler, else None."""
    return find_llvm() or find_compiler()


class SwitchingColumns(Columns):
    """Evaluation by the virtual machine as long as that is cheaper, then by machine code.

    Parameters
    ----------
    function, carried, fixed : as in ``Columns``
    toolchain : Toolchain
    called : the function in the form to compile, if there is another
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
        self._decided = False
        self._announced = 0
        self._seconds = 0.0
        self._columns = 0
        self._instructions = instructions(function)

    def announce(self, count: int) -> None:
        self._announced = count
        if not self._decided:
            self._decide(count)

    def prepare(self, count: int) -> None:
        if self._native is None:
            self._virtual.prepare(count)
        else:  # the report concerns this run only
            self._columns = 0

    @property
    def report(self) -> str:
        """Evaluators of the columns so far."""
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
        if not self._decided:
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
        """Load or compile machine code if the columns so far and ahead justify it."""
        rate = self._seconds / self._columns if self._columns else VIRTUAL_RATE * self._instructions
        remaining = ahead * rate
        if self._compilation is not None:
            self._poll()
            return
        if self._text is None:
            if self._seconds + remaining < TEXT_RATE * self._instructions / 2:
                return
            self._text = c_source(self._called) or ""
            if obstacle(self._text or None, self._toolchain):
                self._decided = True
                return
            self._use(cached_loop(self._text, self._toolchain))
        if not self._decided:
            self._compile(remaining)

    def _compile(self, remaining: float) -> None:
        least = self._toolchain.least_compile_time(str(self._text))
        wait = remaining >= WORTH_WAITING * least and remaining >= WORTH_WAITING * self._time
        if not wait and self._seconds + remaining < min(least, LATEST):
            return
        if not wait and possible():
            self._compilation = Compilation(str(self._text), self._toolchain)
            return
        try:
            self._use(compiled_loop(str(self._text), self._toolchain))
        except UnsupportedError:  # an optional optimisation must not make a run fail
            self._decided = True

    @cached_property
    def _time(self) -> float:
        return self._toolchain.compile_time(str(self._text))

    def _poll(self) -> None:
        """Load the result of the compiling process once it has finished."""
        if self._compilation is not None and not self._compilation.running:
            self._use(cached_loop(str(self._text), self._toolchain))
            self._decided = True

    def _use(self, loop: Call | None) -> None:
        if loop is not None:
            self._native = NativeColumns(
                self._called, loop, self._toolchain.name, self.carried, sorted(self.fixed)
            )
            self._decided = True


def repays(backend: CacheOwner, operations: float, compiled: Sequence[ca.Function]) -> bool:
    """Whether this many operations take longer than compiling functions by LLVM."""
    work = operations * VIRTUAL_RATE
    if find_llvm() is None or work < TEXT_RATE * sum(map(instructions, compiled)):
        return False
    least, times = zip(*(_compile_times(backend, f) for f in compiled), strict=True)
    if work < WORTH_WAITING * sum(least):
        return False
    return work >= WORTH_WAITING * sum(time() for time in times)


@once
def _compile_times(backend: CacheOwner, called: ca.Function) -> tuple[float, Callable[[], float]]:
    """Time to compile a function by LLVM [s]: a lower bound, and a better estimate."""
    text, toolchain = c_source(called) or "", find_llvm()
    assert toolchain is not None
    return toolchain.least_compile_time(text), lru_cache(partial(toolchain.compile_time, text))
