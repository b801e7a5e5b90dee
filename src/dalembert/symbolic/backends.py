"""What evaluates a function of the graph: CasADi's virtual machine, or compiled C.

Both give the same numbers. A backend is asked for each function that is evaluated again and again,
and answers with the function to call instead; it keeps its answers.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.symbolic.compiled import (
    c_source,
    find_compiler,
    hindrance,
    is_whole,
    kept_path,
    load,
    needed_compiler,
)

MANY = 100
"""Columns from which a mapped function is worth a compiler to who asked for C."""
COMPILE_START = 0.1
COMPILE_RATE = 5e-6
SAVED_RATE = 8e-11
"""Rough: seconds to start a compiler, to compile a character of C, and that an evaluation takes
less in C for each character. Machines differ by a factor of a few."""


class Backend(ABC):
    """Chooses how functions are evaluated.

    Attributes
    ----------
    compiles : functions run as C whatever they cost to compile
    """

    compiles = False

    @abstractmethod
    def repeated(self, function: ca.Function, times: int) -> ca.Function:
        """What to call in place of a function that a march calls about ``times`` times more."""

    @abstractmethod
    def mapped(self, function: ca.Function, columns: int) -> ca.Function:
        """What to call in place of a function that is evaluated for many columns at once."""

    @abstractmethod
    def report(self, function: ca.Function) -> str:
        """What evaluates this function, for people."""


class VirtualMachine(Backend):
    """CasADi's own interpreter: ready at once, no compiler needed."""

    def repeated(self, function: ca.Function, times: int) -> ca.Function:
        return function

    def mapped(self, function: ca.Function, columns: int) -> ca.Function:
        return function

    def report(self, function: ca.Function) -> str:
        return "VM"


class Compiled(Backend):
    """C, compiled once and kept on disk.

    Functions that CasADi cannot write as C, those with SUNDIALS inside, stay on the virtual
    machine, so do those too large to be faster as C, and those evaluated for a few columns only.

    Raises
    ------
    UnsupportedError
        When asked: there is no compiler, it fails, or the cache cannot be written.
    """

    compiles = True

    def __init__(self) -> None:
        self._answers: dict[ca.Function, ca.Function] = {}
        self._hindered: dict[ca.Function, str] = {}

    def repeated(self, function: ca.Function, times: int) -> ca.Function:
        if function not in self._answers:
            text = c_source(function)
            self._hindered[function] = hindrance(text)
            if text is None or self._hindered[function]:
                self._answers[function] = function
            else:
                self._answers[function] = load(function, text, needed_compiler())
        return self._answers[function]

    def mapped(self, function: ca.Function, columns: int) -> ca.Function:
        known = function in self._answers or columns >= MANY
        return self.repeated(function, columns) if known else function

    def report(self, function: ca.Function) -> str:
        self.repeated(function, 0)
        why = self._hindered[function]
        return f"VM ({why})" if why else "C"


class Automatic(Backend):
    """C where it is compiled already, or where the work done and announced repays compiling.

    The gain of an evaluation and the time to compile both grow with the length of the C text, so
    that compiling pays from some sixty thousand evaluations on.
    """

    def __init__(self) -> None:
        self._answers: dict[ca.Function, ca.Function] = {}
        self._texts: dict[ca.Function, str | None] = {}
        self._work: dict[ca.Function, int] = {}

    def repeated(self, function: ca.Function, times: int) -> ca.Function:
        if function not in self._answers:
            self._work[function] = self._work.get(function, 0) + times
            if function not in self._texts:
                self._texts[function] = c_source(function)
                self._answer(function, only_kept=not self._repaid(function))
            elif self._repaid(function):
                self._answer(function)
        return self._answers.get(function, function)

    def mapped(self, function: ca.Function, columns: int) -> ca.Function:
        return self.repeated(function, columns)

    def report(self, function: ca.Function) -> str:
        return "VM" if self._answers.get(function, function) is function else "C"

    def _repaid(self, function: ca.Function) -> bool:
        size = len(self._texts[function] or "")
        return SAVED_RATE * size * self._work[function] >= COMPILE_START + COMPILE_RATE * size

    def _answer(self, function: ca.Function, only_kept: bool = False) -> None:
        """Decide for good; ``only_kept`` leaves it open where no library is in the cache."""
        text, compiler = self._texts[function], find_compiler()
        if text is None or hindrance(text) or compiler is None:
            self._answers[function] = function
        elif not only_kept or is_whole(kept_path(text, compiler)):
            try:
                self._answers[function] = load(function, text, compiler)
            except UnsupportedError:  # a run must not fail for what it did not ask for
                self._answers[function] = function


BACKENDS: dict[str, type[Backend]] = {"vm": VirtualMachine, "c": Compiled, "auto": Automatic}
"""Name in ``Dynamics`` → class."""
