"""LLVM, by the llvmlite package: no compiler has to be installed.

Machine code is that of this processor, so that it is filed under its name.
"""

from __future__ import annotations

import ctypes
import sys
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, ClassVar

from dalembert.errors import UnsupportedError
from dalembert.symbolic.native.loop import ENTRY, PIECES, SIGNATURE
from dalembert.symbolic.native.real import LIBRARY
from dalembert.symbolic.native.toolchain import Call, NotTranslated, Toolchain

VERSION = 5
"""Raised when the same text makes other instructions."""
OPTIMISED = 1
"""Level of code generation; none changes how a number is rounded."""
SHORT = 6000
BEGIN, READING, COMPILING = 0.05, 0.1e-6, 45e-6
"""Rough: seconds to begin, for a character, and for each of the operations that differ."""


@dataclass(frozen=True)
class Llvm(Toolchain):
    """LLVM for this machine.

    Parameters
    ----------
    lanes : numbers that are computed side by side, one for each of so many sets of arguments
    short : operations up to which a body is compiled as a whole; in longer ones equal pieces are
        compiled once
    alike : numbers of arguments that are the same in all lanes and given once
    """

    name: ClassVar[str] = "LLVM"
    backend: ClassVar[str] = "jit"
    suffix: ClassVar[str] = ".o"
    maker: ClassVar[tuple[str, str]] = (__name__, "needed_llvm")

    lanes: int = 1
    short: int = SHORT
    alike: tuple[int, ...] = ()

    @cached_property
    def identity(self) -> tuple[str, ...]:
        import llvmlite
        import llvmlite.binding as llvm

        version = ".".join(map(str, llvm.llvm_version_info))
        features = llvm.get_host_cpu_features().flatten()
        about: tuple[str, ...] = (llvmlite.__version__, version, llvm.get_host_cpu_name(), features)
        about += (str(OPTIMISED), str(VERSION), str(self.lanes), str(self.short))
        return (*about, str(self.alike)) if self.alike else about

    def least_effort(self, text: str) -> float:
        return BEGIN + READING * len(text)

    def effort(self, text: str) -> float:
        from dalembert.symbolic.native.translation import different_operations

        try:
            different = different_operations(text, ENTRY, self.short)
        except UnsupportedError:  # what it is will be told when it is compiled
            different = 0
        return self.least_effort(text) + COMPILING * different

    def build(self, text: str, target: Path) -> None:
        from dalembert.symbolic.native.translation import translated

        try:
            code = _object_code(translated(text, ENTRY, self.lanes, self.short, self.alike))
        except NotTranslated:
            raise
        except Exception as error:  # other versions of CasADi may write what nobody has seen
            raise NotTranslated(f"LLVM: {type(error).__name__}: {error}") from None
        target.write_bytes(code)

    def load(self, path: Path) -> Call:
        try:
            return _Loaded(path.read_bytes())
        except RuntimeError as error:
            raise OSError(str(error)) from None


def find_llvm() -> Llvm | None:
    """LLVM where its package is installed."""
    return Llvm() if find_spec("llvmlite") and find_spec("pycparser") else None


@lru_cache
def lane_count() -> int:
    """Numbers that this processor computes with at once."""
    import llvmlite.binding as llvm

    return 8 if llvm.get_host_cpu_features().get("avx512f") else 4


def needed_llvm() -> Llvm:
    """LLVM.

    Raises
    ------
    UnsupportedError
        It is not installed.
    """
    found = find_llvm()
    if found is None:
        raise UnsupportedError(
            "backend 'jit': the packages llvmlite and pycparser are not both installed; "
            "'pip install llvmlite pycparser', or use backend='c' or 'vm', which give the same "
            "results"
        )
    return found


def _machine() -> Any:
    """This machine; an engine takes it over."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    features = llvm.get_host_cpu_features().flatten()
    return llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=features, opt=OPTIMISED, jit=True
    )


def _object_code(module: Any) -> bytes:
    import llvmlite.binding as llvm

    machine = _machine()
    parsed = llvm.parse_assembly(module.text)
    parsed.verify()
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options())
    for name in module.in_memory:
        passes = llvm.create_new_function_pass_manager()
        passes.add_simplify_cfg_pass()
        passes.add_sroa_pass()
        passes.add_instruction_combine_pass()
        passes.add_simplify_cfg_pass()
        passes.run(parsed.get_function(name), builder)
    return machine.emit_object(parsed)


class _Loaded:
    """Machine code in memory, for as long as it is held."""

    def __init__(self, code: bytes):
        import llvmlite.binding as llvm

        _offer_library()
        self._engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine())
        self._engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        self._engine.finalize_object()
        self._loop = SIGNATURE(self._engine.get_function_address(ENTRY))
        counts = (ctypes.c_longlong * 2).from_address(self._engine.get_global_value_address(PIECES))
        self.pieces = tuple(counts)

    def __call__(self, *given: Any) -> int:
        return self._loop(*given)


@lru_cache
def _offer_library() -> None:
    """Tell LLVM where the mathematical functions are that machine code calls."""
    import llvmlite.binding as llvm

    names = {*LIBRARY.values(), "sin", "cos", "sincos", "exp", "log", "pow", "fmin", "fmax"}
    library = ctypes.CDLL("ucrtbase" if sys.platform == "win32" else None)
    if not hasattr(library, "sin"):
        library = ctypes.CDLL("libm.so.6")
    for name in names:
        if hasattr(library, name):
            llvm.add_symbol(name, ctypes.cast(getattr(library, name), ctypes.c_void_p).value)
