"""Toolchain of LLVM by the llvmlite package, which needs no installed compiler.

Machine code is specific to the processor, whose name is part of its identity.
"""

from __future__ import annotations

import ctypes
import sys
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from dalembert.errors import UnsupportedError
from dalembert.symbolic.native.real import LIBRARY
from dalembert.symbolic.native.toolchain import (
    ENTRY,
    PIECES,
    SIGNATURE,
    Call,
    NotTranslated,
    Toolchain,
)

if TYPE_CHECKING:
    from dalembert.symbolic.native.translation import Module

VERSION = 6
"""Incremented when the same text yields other instructions."""
OPTIMISED = 1
"""Optimisation level of code generation; no level changes rounding."""
SHORT = 6000
BEGIN, READING, COMPILING = 0.05, 0.1e-6, 45e-6
"""Estimated compile time: constant, per character, and per distinct operation [s]."""


@dataclass(frozen=True)
class Llvm(Toolchain):
    """LLVM for this machine.

    Parameters
    ----------
    lanes : sets of arguments evaluated side by side
    short : upper limit of operations of a body that is compiled as a whole; in longer ones equal
        pieces are compiled once
    uniform : indices of arguments that are equal in all lanes and passed once
    vectorised : whether loops are optimised, which takes longer and does not change rounding
    """

    name: ClassVar[str] = "LLVM"
    backend: ClassVar[str] = "jit"
    suffix: ClassVar[str] = ".o"
    maker: ClassVar[tuple[str, str]] = (__name__, "require_llvm")

    lanes: int = 1
    short: int = SHORT
    uniform: tuple[int, ...] = ()
    vectorised: bool = False

    @cached_property
    def identity(self) -> tuple[str, ...]:
        import llvmlite.binding as llvm

        features = llvm.get_host_cpu_features().flatten()
        identity = (*llvm_identity(), llvm.get_host_cpu_name(), features)
        identity += (str(OPTIMISED), str(VERSION), str(self.lanes), str(self.short))
        identity += (str(self.uniform),) if self.uniform else ()
        return (*identity, "vectorised") if self.vectorised else identity

    def for_loops(self) -> Llvm:
        return replace(self, vectorised=True)

    def least_compile_time(self, text: str) -> float:
        return BEGIN + READING * len(text)

    def compile_time(self, text: str) -> float:
        from dalembert.symbolic.native.translation import distinct_operations

        try:
            distinct = distinct_operations(text, ENTRY, self.short)
        except UnsupportedError:  # raised again when it is compiled
            distinct = 0
        return self.least_compile_time(text) + COMPILING * distinct

    def build(self, text: str, target: Path) -> None:
        from dalembert.symbolic.native.translation import translate

        try:
            module = translate(text, [ENTRY], self.lanes, self.short, self.uniform)
            code = emit_object(module, _machine(), vectorised=self.vectorised)
        except NotTranslated:
            raise
        except Exception as error:  # other versions of CasADi may write unknown C
            raise NotTranslated(f"LLVM: {type(error).__name__}: {error}") from None
        target.write_bytes(code)

    def load(self, path: Path) -> Call:
        try:
            return _Loaded(path.read_bytes())
        except RuntimeError as error:
            raise OSError(str(error)) from None


def llvm_identity() -> tuple[str, ...]:
    """Versions of llvmlite and LLVM."""
    import llvmlite
    import llvmlite.binding as llvm

    return llvmlite.__version__, ".".join(map(str, llvm.llvm_version_info))


def find_llvm() -> Llvm | None:
    """LLVM if its packages are installed, else None."""
    return Llvm() if find_spec("llvmlite") and find_spec("pycparser") else None


@lru_cache
def lane_count() -> int:
    """Number of doubles in a vector register of this processor."""
    import llvmlite.binding as llvm

    return 8 if llvm.get_host_cpu_features().get("avx512f") else 4


def require_llvm() -> Llvm:
    """LLVM.

    Raises
    ------
    UnsupportedError
        The packages are not installed.
    """
    toolchain = find_llvm()
    if toolchain is None:
        raise UnsupportedError(
            "backend 'jit': the packages llvmlite and pycparser are not both installed; "
            "'pip install llvmlite pycparser', or use backend='c' or 'vm', which give the same "
            "results"
        )
    return toolchain


def _machine() -> Any:
    """Target machine of this processor; an engine takes ownership of it."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    features = llvm.get_host_cpu_features().flatten()
    return llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=features, opt=OPTIMISED, jit=True
    )


def emit_object(module: Module, machine: Any, triple: str = "", vectorised: bool = False) -> bytes:
    """Object file of a module for a target machine; ``triple`` names another than this one."""
    import llvmlite.binding as llvm

    parsed = llvm.parse_assembly(module.text)
    if triple:
        parsed.triple, parsed.data_layout = triple, str(machine.target_data)
    parsed.verify()
    tuning = llvm.create_pipeline_tuning_options()
    tuning.slp_vectorization = vectorised
    builder = llvm.create_pass_builder(machine, tuning)
    if vectorised:
        builder.getModulePassManager().run(parsed, builder)
        return bytes(machine.emit_object(parsed))
    for name in module.in_memory:
        passes = llvm.create_new_function_pass_manager()
        passes.add_simplify_cfg_pass()
        passes.add_sroa_pass()
        passes.add_instruction_combine_pass()
        passes.add_simplify_cfg_pass()
        passes.run(parsed.get_function(name), builder)
    return bytes(machine.emit_object(parsed))


class _Loaded:
    """Machine code in memory, as long as the object exists."""

    def __init__(self, code: bytes):
        import llvmlite.binding as llvm

        _register_library()
        self._engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine())
        self._engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        self._engine.finalize_object()
        self.entry = SIGNATURE(self._engine.get_function_address(ENTRY))
        counts = (ctypes.c_longlong * 2).from_address(self._engine.get_global_value_address(PIECES))
        self.pieces = tuple(counts)

    def __call__(self, *arguments: Any) -> int:
        return self.entry(*arguments)


@lru_cache
def _register_library() -> None:
    """Register the mathematical functions called by machine code with LLVM."""
    import llvmlite.binding as llvm

    names = {*LIBRARY.values(), "sin", "cos", "sincos", "exp", "log", "pow", "fmin", "fmax"}
    library = ctypes.CDLL("ucrtbase" if sys.platform == "win32" else None)
    if not hasattr(library, "sin"):
        library = ctypes.CDLL("libm.so.6")
    for name in names:
        if hasattr(library, name):
            llvm.add_symbol(name, ctypes.cast(getattr(library, name), ctypes.c_void_p).value)
