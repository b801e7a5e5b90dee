"""Repeated evaluation of a function on arrays of the caller, with the least overhead per call."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from io import StringIO
from typing import Any

import casadi as ca
import numpy as np

from dalembert.symbolic.evaluation.columns import NativeColumns, dense
from dalembert.symbolic.evaluation.switching import best_toolchain
from dalembert.symbolic.native.code_cache import compiled_loop
from dalembert.symbolic.native.source import c_source, obstacle
from dalembert.symbolic.native.toolchain import NotTranslated

FixedCall = Callable[[], int]
"""Evaluates once; 1 if it succeeds, 0 if a solver inside fails."""


class FixedCalls:
    """A function as machine code if that is available, else by CasADi's virtual machine.

    Parameters
    ----------
    function : dense in all inputs and outputs
    compiled : whether machine code may be used
    """

    def __init__(self, function: ca.Function, compiled: bool = True):
        self.function = dense(function)
        self._native = self._compiled() if compiled else None

    @property
    def report(self) -> str:
        """Name of the evaluator."""
        return "VM" if self._native is None else self._native.report

    def _compiled(self) -> NativeColumns | None:
        toolchain, text = best_toolchain(), c_source(self.function)
        if toolchain is None or text is None or obstacle(text, toolchain):
            return None
        try:
            loop = compiled_loop(text, toolchain)
        except NotTranslated:
            return None
        return NativeColumns(self.function, loop, toolchain.name)

    def on(self, arguments: Sequence[np.ndarray], results: Sequence[np.ndarray]) -> FixedCall:
        """The function on flat arrays, from which it reads and into which it writes."""
        if self._native is not None:
            return self._native.bound(1, arguments, results)
        buffer: Any
        buffer, trigger = self.function.buffer()
        for i, argument in enumerate(arguments):
            buffer.set_arg(i, argument.data)
        for i, result in enumerate(results):
            buffer.set_res(i, memoryview(result.data))

        def evaluate() -> int:
            shown, sys.stderr = sys.stderr, StringIO()  # CasADi prints all arguments on failure
            try:
                trigger()
            except RuntimeError:
                return 0
            finally:
                sys.stderr = shown
            return 0 if buffer.ret() else 1

        return evaluate
