"""WebAssembly of graph functions, by the same translation to LLVM IR as machine code.

A module holds several functions, each with its loop over columns, and needs no linker: LLVM emits
an object file, to which an export section is added.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.symbolic.evaluation.columns import dense
from dalembert.symbolic.native.code_cache import compiled_bytes
from dalembert.symbolic.native.llvm import SHORT, emit_object, llvm_identity, require_llvm
from dalembert.symbolic.native.source import c_sources, loop_name
from dalembert.symbolic.native.toolchain import Compiler, NotTranslated
from dalembert.symbolic.native.web_object import data_end, imported, linked, sections

TRIPLE = "wasm32-unknown-unknown"
OPTIMISED = 1
"""Optimisation level of code generation."""
TEXT_PER_BYTE = 6.0
"""Upper limit of the length of the C text per byte of the module; 2 to 5 in the examples."""
VERSION = 1
"""Incremented when the same text yields other instructions."""


@dataclass(frozen=True)
class WebFunction:
    """Sizes of a function of a module.

    Attributes
    ----------
    inputs, outputs : numbers of entries of the arguments and results of one column
    work : lengths of the work vectors ``arg, res, iw, w``
    """

    inputs: tuple[int, ...]
    outputs: tuple[int, ...]
    work: tuple[int, int, int, int]


@dataclass(frozen=True)
class WebModule:
    """WebAssembly module of several functions.

    Each exported function ``dalembert_NAME`` is the loop over columns of ``toolchain.LOOP``. The
    module imports ``env.__linear_memory`` and mathematical functions of the C library.

    Attributes
    ----------
    code : the module
    functions : name → WebFunction
    imports : names of the imported mathematical functions
    data_end : first byte of memory that the module does not occupy
    """

    code: bytes
    functions: Mapping[str, WebFunction]
    imports: tuple[str, ...]
    data_end: int


@dataclass(frozen=True)
class WebAssembly(Compiler):
    """Compiler of C text to a module that exports some of its functions.

    Parameters
    ----------
    exports : names of the functions
    """

    backend: ClassVar[str] = "WebAssembly"
    suffix: ClassVar[str] = ".wasm"

    exports: tuple[str, ...]

    @cached_property
    def identity(self) -> tuple[str, ...]:
        return (*llvm_identity(), TRIPLE, str(OPTIMISED), str(VERSION), *self.exports)

    def build(self, text: str, target: Path) -> None:
        from dalembert.symbolic.native.translation import translate

        try:
            module = translate(text, self.exports, 1, SHORT)
            code = linked(emit_object(module, _machine(), TRIPLE), self.exports)
        except NotTranslated:
            raise
        except Exception as error:  # other versions of CasADi may write unknown C
            raise NotTranslated(f"WebAssembly: {type(error).__name__}: {error}") from None
        target.write_bytes(code)


@dataclass(frozen=True)
class WebSource:
    """C text of a module.

    Attributes
    ----------
    functions : name → dense function
    text : of all functions
    """

    functions: Mapping[str, ca.Function]
    text: str

    @classmethod
    def of(cls, functions: Mapping[str, ca.Function]) -> WebSource:
        """Source of functions.

        Raises
        ------
        UnsupportedError
            A function cannot be written as C, or packages are missing.
        """
        require_llvm()
        dense_functions = {name: dense(function) for name, function in functions.items()}
        text = c_sources(dense_functions)
        if text is None:
            raise UnsupportedError("CasADi cannot write these functions as C")
        return cls(dense_functions, text)

    @property
    def smallest_size(self) -> float:
        """Size below which the module is not [bytes]."""
        return len(self.text) / TEXT_PER_BYTE

    def module(self) -> WebModule:
        """The compiled module, from the cache of compiled functions if it is there.

        Raises
        ------
        UnsupportedError
            A function cannot be translated.
        """
        code = compiled_bytes(self.text, WebAssembly(tuple(map(loop_name, self.functions))))
        sizes = {name: _sizes(function) for name, function in self.functions.items()}
        parts = sections(code)
        return WebModule(code, sizes, imported(parts), data_end(parts))


def _machine() -> Any:
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(TRIPLE).create_target_machine(opt=OPTIMISED)


def _sizes(f: ca.Function) -> WebFunction:
    return WebFunction(
        tuple(f.numel_in(i) for i in range(f.n_in())),
        tuple(f.numel_out(i) for i in range(f.n_out())),
        (f.sz_arg() + f.n_in(), f.sz_res() + f.n_out(), f.sz_iw() + 1, f.sz_w() + 1),
    )
