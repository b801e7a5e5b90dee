"""Layout of Python code: literals and calls, broken into lines of limited width."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

WIDTH = 96
"""Upper limit of the length of a line, where its parts allow it [characters]."""
INDENT = "    "
Statements = Iterator[tuple[str, Any]]
"""Variable, or an empty text, and the code that it is assigned."""


@dataclass(frozen=True)
class Code:
    """Parts in brackets, such as the arguments of a call.

    Attributes
    ----------
    opening, closing : text before and behind the parts
    parts : texts or code
    """

    opening: str
    parts: Sequence[Any] = field(default_factory=tuple)
    closing: str = ")"

    def __str__(self) -> str:
        inner = ", ".join(map(str, self.parts))
        if self.opening == "(" and len(self.parts) == 1:
            inner += ","
        return f"{self.opening}{inner}{self.closing}"

    def lines(self, indent: str, before: str = "", behind: str = "") -> list[str]:
        """Lines of the code with texts before and behind it."""
        flat = f"{indent}{before}{self}{behind}"
        if len(flat) <= WIDTH or not self.parts:
            return [flat]
        lines = [f"{indent}{before}{self.opening}"]
        if all(isinstance(part, str) and len(part) < 30 for part in self.parts):
            lines += _filled(self.parts, indent + INDENT)
        else:
            comma = "" if len(self.parts) == 1 and isinstance(self.parts[0], Code) else ","
            for part in self.parts:
                lines += lines_of(part, indent + INDENT, behind=comma)
        return [*lines, f"{indent}{self.closing}{behind}"]


@dataclass(frozen=True)
class Keyword:
    """A value with text before it: ``key=value`` of a call, or ``"key": value`` of a table.

    Attributes
    ----------
    prefix : ``key=``
    value : text or code
    """

    prefix: str
    value: Any

    def __str__(self) -> str:
        return f"{self.prefix}{self.value}"


def lines_of(part: Any, indent: str, before: str = "", behind: str = "") -> list[str]:
    """Lines of a text or code with texts before and behind it."""
    if isinstance(part, Keyword):
        return lines_of(part.value, indent, before + part.prefix, behind)
    if isinstance(part, Code):
        return part.lines(indent, before, behind)
    return [f"{indent}{before}{part}{behind}"]


def _filled(parts: Sequence[str], indent: str) -> list[str]:
    """Short parts, as many in each line as it holds."""
    lines = [indent]
    for part in parts:
        if len(lines[-1]) + len(part) + 2 > WIDTH and lines[-1] != indent:
            lines.append(indent)
        lines[-1] += f"{'' if lines[-1] == indent else ' '}{part},"
    return lines


def call(function: str, *arguments: Any, **keywords: Any) -> Code:
    """Call of a function; arguments are code."""
    named = (Keyword(f"{key}=", value) for key, value in keywords.items())
    return Code(f"{function}(", (*arguments, *named))


def table(entries: Mapping[str, Any]) -> Code:
    """Dictionary with text keys; values are code."""
    parts = [Keyword(f"{quoted(key)}: ", value) for key, value in entries.items()]
    return Code("{", parts, "}")


def vector(entries: Iterable[Any]) -> Code:
    """Tuple of code."""
    return Code("(", tuple(entries))


def quoted(text: str) -> str:
    """Literal of a text; no text can end it."""
    try:
        text.encode()
    except UnicodeEncodeError:  # half of a surrogate pair
        return json.dumps(text)
    return json.dumps(text, ensure_ascii=False)


def number(value: float) -> str:
    """Literal of a number, which reads back to the same number."""
    if isinstance(value, float) and not math.isfinite(value):
        return "math.nan" if math.isnan(value) else "math.inf" if value > 0 else "-math.inf"
    short = f"{value:.6g}".replace("e+", "e")
    exact = isinstance(value, float) and "e" in short and float(short) == value
    return short if exact else repr(value)


def literal(value: Any) -> Any:
    """Literal of plain data.

    Raises
    ------
    TypeError
        No plain data.
    """
    if isinstance(value, str):
        return quoted(value)
    if value is None or isinstance(value, bool):
        return repr(value)
    if isinstance(value, (int, float)):
        return number(value)
    if isinstance(value, tuple):
        return vector(literal(item) for item in value)
    if isinstance(value, list):
        return Code("[", [literal(item) for item in value], "]")
    if isinstance(value, dict):
        return table({str(key): literal(item) for key, item in value.items()})
    raise TypeError(f"no literal of {type(value).__name__}")
