"""WebAssembly of graph functions, by the same translation to LLVM IR as machine code.

A module holds several functions, each with its loop over columns, and needs no linker: LLVM emits
an object file, to which an export section is added.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.symbolic.evaluation.columns import dense
from dalembert.symbolic.native.llvm import SHORT, emit_object, require_llvm
from dalembert.symbolic.native.source import c_sources, loop_name
from dalembert.symbolic.native.toolchain import NotTranslated
from dalembert.symbolic.native.translation import translate

TRIPLE = "wasm32-unknown-unknown"
OPTIMISED = 0
"""Optimisation level of code generation."""
MAGIC = b"\0asm\1\0\0\0"
CUSTOM, IMPORT, EXPORT, ELEMENT, DATA = 0, 2, 7, 9, 11
"""Numbers of sections of a module."""


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


def web_module(functions: Mapping[str, ca.Function]) -> WebModule:
    """WebAssembly of functions, by name.

    Raises
    ------
    UnsupportedError
        A function cannot be written as C or translated, or packages are missing.
    """
    require_llvm()
    dense_functions = {name: dense(function) for name, function in functions.items()}
    text = c_sources(dense_functions)
    if text is None:
        raise UnsupportedError("CasADi cannot write these functions as C")
    try:
        module = translate(text, [loop_name(name) for name in functions], 1, SHORT)
        code = emit_object(module, _machine(), TRIPLE)
    except NotTranslated:
        raise
    except Exception as error:  # other versions of CasADi may write unknown C
        raise NotTranslated(f"WebAssembly: {type(error).__name__}: {error}") from None
    sections = list(_sections(code))
    exported = {loop_name(name): _index(sections, loop_name(name)) for name in functions}
    sizes = {name: _sizes(function) for name, function in dense_functions.items()}
    return WebModule(
        _with_exports(sections, exported), sizes, _imported(sections), _data_end(sections)
    )


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


# Object files: https://github.com/WebAssembly/tool-conventions/blob/main/Linking.md ---------------


class _Bytes:
    """Reader of the binary format."""

    def __init__(self, data: bytes, at: int = 0):
        self.data, self.at = data, at

    def __bool__(self) -> bool:
        return self.at < len(self.data)

    def byte(self) -> int:
        self.at += 1
        return self.data[self.at - 1]

    def number(self) -> int:
        """Unsigned LEB128."""
        value = shift = 0
        while True:
            byte = self.byte()
            value |= (byte & 0x7F) << shift
            shift += 7
            if not byte & 0x80:
                return value

    def signed(self) -> int:
        """Signed LEB128 of at most 32 bits."""
        value = shift = 0
        while True:
            byte = self.byte()
            value |= (byte & 0x7F) << shift
            shift += 7
            if not byte & 0x80:
                return value - (1 << shift) if byte & 0x40 else value

    def take(self, count: int) -> bytes:
        self.at += count
        return self.data[self.at - count : self.at]

    def name(self) -> str:
        return self.take(self.number()).decode()


def _leb(value: int) -> bytes:
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*out, value])


def _sections(code: bytes) -> Iterator[tuple[int, bytes]]:
    """Number and content of each section."""
    reader = _Bytes(code, len(MAGIC))
    while reader:
        number = reader.byte()
        yield number, reader.take(reader.number())


def _index(sections: list[tuple[int, bytes]], function: str) -> int:
    """Index of a function, from the symbol table of the section ``linking``."""
    table, function_kind, data_kind, section_kind = 8, 0, 1, 3
    undefined, explicit = 0x10, 0x40
    for number, content in sections:
        reader = _Bytes(content)
        if number != CUSTOM or reader.name() != "linking":
            continue
        reader.number()  # version
        while reader:
            kind, part = reader.byte(), _Bytes(reader.take(reader.number()))
            for _ in range(part.number() if kind == table else 0):
                symbol, flags = part.byte(), part.number()
                if symbol == section_kind:
                    part.number()
                elif symbol == data_kind:
                    part.name()
                    for _ in range(0 if flags & undefined else 3):
                        part.number()
                else:
                    index = part.number()
                    named = not flags & undefined or flags & explicit
                    if named and part.name() == function and symbol == function_kind:
                        return index
    raise NotTranslated(f"WebAssembly: no symbol {function}")


def _with_exports(sections: list[tuple[int, bytes]], functions: Mapping[str, int]) -> bytes:
    """The module with exported functions, without custom sections."""
    entries = [_leb(len(n)) + n.encode() + b"\0" + _leb(k) for n, k in functions.items()]
    exports = _leb(len(entries)) + b"".join(entries)
    kept = [section for section in sections if section[0] != CUSTOM]
    before = [section for section in kept if section[0] < EXPORT]
    after = [section for section in kept if section[0] > EXPORT]
    ordered = [*before, (EXPORT, exports), *after]
    return MAGIC + b"".join(bytes([k]) + _leb(len(body)) + body for k, body in ordered)


def _imported(sections: list[tuple[int, bytes]]) -> tuple[str, ...]:
    """Names of imported functions."""
    names = []
    for number, content in sections:
        reader = _Bytes(content)
        for _ in range(reader.number() if number == IMPORT else 0):
            reader.name()
            name, kind = reader.name(), reader.byte()
            if kind == 0:  # function: index of its type
                reader.number()
                names.append(name)
                continue
            if kind == 3:  # global: type, mutability
                reader.take(2)
                continue
            if kind == 1:  # table: type of its entries before the limits
                reader.byte()
            for _ in range(2 if reader.byte() else 1):
                reader.number()
    return tuple(names)


def _data_end(sections: list[tuple[int, bytes]]) -> int:
    """First byte behind the constants of a module."""
    end = 0
    constant_i32, end_of_code = 0x41, 0x0B
    for number, content in sections:
        reader = _Bytes(content)
        for _ in range(reader.number() if number == DATA else 0):
            kind, opcode = reader.number(), reader.byte()
            offset = reader.signed()
            if kind != 0 or opcode != constant_i32 or reader.byte() != end_of_code:
                raise NotTranslated("WebAssembly: data of an unknown kind")
            size = reader.number()
            reader.take(size)
            end = max(end, offset + size)
    return end
