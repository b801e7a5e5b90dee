"""TOML text of a model file in the layout of the examples.

Values of the file come first, then sections. The table of an element has its own heading, small
tables and the entries of ``[parameters]`` are written on one line. Libraries that write TOML offer
no such choice of layout.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

WIDTH = 100
"""Upper limit of the length of a line; longer arrays and tables are divided where possible."""
ON_ONE_LINE = ("parameters", "derived", "inputs", "outputs")
"""Sections with one line for each entry."""
BARE = re.compile(r"[A-Za-z0-9_-]+")
DELETE = "\x7f"
"""Control character that JSON permits in texts, and TOML does not."""

Keys = tuple[str, ...]


def toml_text(document: Mapping[str, Any], comments: Mapping[str, str]) -> str:
    """The text of a model file; reading it returns exactly the same values.

    Parameters
    ----------
    document : sections of the file as plain data
    comments : dotted key → comment above it; the empty key is the heading of the file
    """
    heading = list(_comment("", comments))
    lines = [*heading, *([""] if heading else []), *_table((), document, comments)]
    return "\n".join(lines).strip("\n") + "\n"


def _table(keys: Keys, table: Mapping[str, Any], comments: Mapping[str, str]) -> Iterator[str]:
    """Values of a table, then the tables in it that have headings."""
    headed = {key for key, value in table.items() if _has_heading(keys, key, value)}
    for key, value in table.items():
        if key not in headed:
            yield from _comment(".".join((*keys, key)), comments)
            yield from _entry(key, value)
    for key in table:
        if key in headed:
            yield from _section((*keys, key), table[key], comments)


def _section(keys: Keys, value: Any, comments: Mapping[str, str]) -> Iterator[str]:
    """A table, or an array of tables, each with its heading."""
    is_array = isinstance(value, list)
    name, comment = ".".join(map(_key, keys)), list(_comment(".".join(keys), comments))
    for table in value if is_array else [value]:
        has_values = any(not _has_heading(keys, key, entry) for key, entry in table.items())
        if has_values or is_array or not table or comment:
            yield ""
            yield from comment
            yield f"[[{name}]]" if is_array else f"[{name}]"
        yield from _table(keys, table, comments)


def _has_heading(keys: Keys, key: str, value: Any) -> bool:
    """Whether a value is a section, the table of an element, or a table too long for a line."""
    if not keys:
        return isinstance(value, dict) or _is_array_of_tables(value)
    if not isinstance(value, dict) or not value:
        return False
    if len(keys) == 1:
        return keys[0] not in ON_ONE_LINE
    return len(keys) == 2 and len(f"{_key(key)} = {_text(value)}") > WIDTH


def _is_array_of_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(v, dict) for v in value)


def _comment(key: str, comments: Mapping[str, str]) -> Iterator[str]:
    for line in comments.get(key, "").splitlines():
        yield f"# {_escaped(line)}".rstrip()


def _escaped(line: str) -> str:
    """A comment without characters that TOML refuses."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in line)


def _entry(key: str, value: Any) -> Iterator[str]:
    """A value on one line, a long array on several."""
    line = f"{_key(key)} = {_text(value)}"
    if len(line) <= WIDTH or not isinstance(value, (list, tuple)) or not value:
        yield line
        return
    yield f"{_key(key)} = ["
    for row in _rows(value):
        yield f"  {row},"
    yield "]"


def _rows(values: Sequence[Any]) -> Iterator[str]:
    """Entries of a long array: tables and arrays on a line each, numbers side by side."""
    row = ""
    for value in values:
        text = _text(value)
        if isinstance(value, (dict, list, tuple)) or len(row) + len(text) + 4 > WIDTH:
            if row:
                yield row
            row = text
        else:
            row = f"{row}, {text}" if row else text
    yield row


def _key(name: str) -> str:
    return name if BARE.fullmatch(name) else _quoted(name)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace(DELETE, "\\u007f")


def _text(value: Any) -> str:
    """A value on one line."""
    if isinstance(value, dict):
        entries = ", ".join(f"{_key(key)} = {_text(entry)}" for key, entry in value.items())
        return f"{{ {entries} }}" if entries else "{}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_text, value))}]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return number_text(value)
    return str(value) if isinstance(value, int) else _quoted(str(value))


def number_text(value: float) -> str:
    """The shortest text that is read as this number: ``2.0``, ``7e10``, ``-0.25``."""
    text = repr(float(value) + 0.0)  # no negative zero
    mantissa, exponent, power = text.partition("e")
    if exponent:
        return f"{mantissa}e{int(power)}"
    digits = text.removesuffix(".0").rstrip("0")
    if text.endswith("00000.0"):
        sign, digits = ("-", digits[1:]) if digits[0] == "-" else ("", digits)
        fraction = f".{digits[1:]}" if len(digits) > 1 else ""
        return f"{sign}{digits[0]}{fraction}e{len(text.lstrip('-')) - len('0.0')}"
    return text
