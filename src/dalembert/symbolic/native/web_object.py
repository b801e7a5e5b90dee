"""Object files of WebAssembly: sections, symbols, and the export section that makes a module.

Format: https://github.com/WebAssembly/tool-conventions/blob/main/Linking.md
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from dalembert.symbolic.native.toolchain import NotTranslated

MAGIC = b"\0asm\1\0\0\0"
CUSTOM, IMPORT, EXPORT, DATA = 0, 2, 7, 11
"""Numbers of sections of a module."""
Sections = list[tuple[int, bytes]]
"""Number and content of each section."""


def linked(code: bytes, names: Sequence[str]) -> bytes:
    """Module of an object file that exports some of its functions."""
    parts = sections(code)
    return _with_exports(parts, {name: _index(parts, name) for name in names})


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


def sections(code: bytes) -> Sections:
    """Sections of a module or an object file."""
    reader, parts = _Bytes(code, len(MAGIC)), []
    while reader:
        number = reader.byte()
        parts.append((number, reader.take(reader.number())))
    return parts


def _index(sections: Sections, function: str) -> int:
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


def _with_exports(sections: Sections, functions: Mapping[str, int]) -> bytes:
    """The module with exported functions, without custom sections."""
    entries = [_leb(len(n)) + n.encode() + b"\0" + _leb(k) for n, k in functions.items()]
    exports = _leb(len(entries)) + b"".join(entries)
    kept = [section for section in sections if section[0] != CUSTOM]
    before = [section for section in kept if section[0] < EXPORT]
    after = [section for section in kept if section[0] > EXPORT]
    ordered = [*before, (EXPORT, exports), *after]
    return MAGIC + b"".join(bytes([k]) + _leb(len(body)) + body for k, body in ordered)


def imported(sections: Sections) -> tuple[str, ...]:
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


def data_end(sections: Sections) -> int:
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
