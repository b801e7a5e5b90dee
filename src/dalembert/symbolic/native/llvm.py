"""LLVM, by the llvmlite package: no compiler has to be installed.

The instructions are those of this processor, so that objects are filed under its name.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import sys
from functools import lru_cache

from dalembert.symbolic.native.real import LIBRARY
from dalembert.symbolic.native.source import ENTRY
from dalembert.symbolic.native.translation import Module, translated

OPTIMISED = 1
"""Level of code generation; nothing that changes a rounding is done at any."""


def _target():
    """The machine that this process runs on; an engine takes it over."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    features = llvm.get_host_cpu_features().flatten()
    target = llvm.Target.from_default_triple()
    return target.create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=features, opt=OPTIMISED, jit=True
    )


def object_code(text: str, lanes: int = 1) -> bytes:
    """Machine code of a C text's loop over columns."""
    return _compiled(translated(text, ENTRY, ENTRY, lanes))


def _compiled(module: Module) -> bytes:
    import llvmlite.binding as llvm

    machine = _target()
    parsed = llvm.parse_assembly(module.text)
    parsed.verify()
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options())
    for name in module.looped:
        passes = llvm.create_new_function_pass_manager()
        passes.add_simplify_cfg_pass()
        passes.add_sroa_pass()
        passes.add_instruction_combine_pass()
        passes.add_simplify_cfg_pass()
        passes.run(parsed.get_function(name), builder)
    return machine.emit_object(parsed)


class Loaded:
    """Machine code in memory.

    Attributes
    ----------
    call : the C function
    """

    def __init__(self, code: bytes):
        import llvmlite.binding as llvm

        _offer_library()
        self._engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _target())
        self._engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        self._engine.finalize_object()
        self.address = self._engine.get_function_address(ENTRY)


@lru_cache
def _offer_library() -> None:
    """Tell LLVM where the mathematical functions are that objects call."""
    import llvmlite.binding as llvm

    if sys.platform == "win32":
        library = ctypes.CDLL("ucrtbase")
    else:
        library = ctypes.CDLL(ctypes.util.find_library("m") or None)
    for name in {*LIBRARY.values(), "sin", "cos", "exp", "log", "pow", "fmin", "fmax"}:
        if hasattr(library, name):
            llvm.add_symbol(name, ctypes.cast(getattr(library, name), ctypes.c_void_p).value)
