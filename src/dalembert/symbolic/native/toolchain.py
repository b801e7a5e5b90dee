"""Interfaces of compilers: C text → file, and C text of a function → callable loop over columns."""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

from dalembert.errors import UnsupportedError


class NotTranslated(UnsupportedError):
    """A text contains something unknown to a toolchain; others may support it."""


Call = Callable[..., int]
"""The loop over columns, on addresses; it returns the number of completed columns."""
ENTRY = "dalembert_columns"
"""Name of the loop in a library."""
FIRST = "casadi_f0"
"""Name of the function called by the loop."""
PIECES = "dalembert_pieces"
"""Name of two numbers in a library of LLVM: pieces of straight-line code, and distinct pieces."""
SIGNATURE = ctypes.CFUNCTYPE(ctypes.c_longlong, *[ctypes.c_longlong] * 3, *[ctypes.c_void_p] * 8)
"""Type of the loop: three counts and eight addresses."""
LOOP = """
/* how many columns were done: all, or those before the first that fails */
CASADI_SYMBOL_EXPORT casadi_int {entry}(casadi_int count, casadi_int n_in, casadi_int n_out,
    const casadi_real** from, const casadi_int* from_step, casadi_real** to,
    const casadi_int* to_step, const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w) {{
  casadi_int k, i;
  for (k=0; k<count; ++k) {{
    for (i=0; i<n_in; ++i) arg[i] = from[i]+k*from_step[i];
    for (i=0; i<n_out; ++i) res[i] = to[i]+k*to_step[i];
    if ({function}(arg, res, iw, w, 0)) return k;
  }}
  return count;
}}
"""
"""C text of the loop over columns of a function."""


class Compiler(ABC):
    """Compiler of C text to a file.

    Attributes
    ----------
    backend : name of the backend
    suffix : of its files
    """

    backend: ClassVar[str]
    suffix: ClassVar[str]

    @property
    @abstractmethod
    def identity(self) -> tuple[str, ...]:
        """Everything that its files depend on, besides the text."""

    @abstractmethod
    def build(self, text: str, target: Path) -> None:
        """Compile a text to a file.

        Raises
        ------
        UnsupportedError
            The text cannot be compiled; ``NotTranslated`` if its content is not supported.
        """


class Toolchain(Compiler):
    """Compiler of C text to machine code.

    Attributes
    ----------
    name : in reports
    maker : module and name of its constructor, for another process
    longest : upper limit of characters of C, above which code that does not fit the cache gains
        little over the virtual machine, whose instructions are shorter; None if the number of
        characters is no measure
    """

    name: ClassVar[str]
    maker: ClassVar[tuple[str, str]]
    longest: ClassVar[int | None] = None

    def for_loops(self) -> Toolchain:
        """The toolchain for texts that consist of long loops over arrays."""
        return self

    @abstractmethod
    def least_compile_time(self, text: str) -> float:
        """Lower bound of the estimated compile time of a text [s]."""

    def compile_time(self, text: str) -> float:
        """Estimated compile time of a text [s], by a closer analysis."""
        return self.least_compile_time(text)

    @abstractmethod
    def load(self, path: Path) -> Call:
        """The loop of a file.

        Raises
        ------
        OSError
            The file cannot be loaded.
        """
