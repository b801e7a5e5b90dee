"""Texts of classes as Markdown."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable

FIELD = re.compile(r"^(\w+(?:, \w+)*) : (.*)$")


def summary(cls: type) -> str:
    """Text of a docstring before its sections, as Markdown."""
    text = inspect.getdoc(cls) or ""
    return markdown(re.split(r"\n\n\w+\n-+\n", text)[0])


def field_texts(cls: type) -> dict[str, str]:
    """Parameter → description, from the docstrings of a class and its bases."""
    found: dict[str, str] = {}
    for base in reversed(cls.__mro__):
        names: list[str] = []
        for line in inspect.cleandoc(vars(base).get("__doc__") or "").splitlines():
            match = FIELD.match(line)
            if match:
                names = match[1].split(", ")
                found |= dict.fromkeys(names, match[2])
            elif line.startswith("    ") and names:
                found |= {n: f"{found[n]} {line.strip()}" for n in names}
            else:
                names = []
    return found


def markdown(text: str) -> str:
    return re.sub(r"``([^`]+)``", r"`\1`", text).strip()


def cell(text: object) -> str:
    return " ".join(markdown(str(text)).replace("|", "\\|").split()) or " "


def table(headings: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    lines = ["| " + " | ".join(headings) + " |", "|" + "---|" * len(list(headings))]
    return "\n".join([*lines, *("| " + " | ".join(map(cell, row)) + " |" for row in rows)])
