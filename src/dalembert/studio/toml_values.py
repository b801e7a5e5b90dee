"""Values of a model file as TOML: numbers in their units, lists and tables in one line."""

from __future__ import annotations

import re
from typing import Any

from dalembert.errors import ExpressionError, ModelError
from dalembert.units.unit import unit

MAX_TEXT = 400
"""Upper limit of the length of a text value [characters]."""
MEASURED = re.compile(r"\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s*([^\W\d].*?)\s*")
NAME = re.compile(r"[A-Za-z_]\w{0,79}", re.ASCII)
"""A name of an entry."""


def is_number(value: Any) -> bool:
    """Whether a value is a number; true and false are none."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def with_unit(old: str, value: float) -> str | None:
    """A value in SI units in the unit of a text such as ``45 mm``; None for a formula."""
    match = MEASURED.fullmatch(old)
    if match is None:
        return None
    try:
        return f"{in_unit(value, match[1])!r} {match[1]}"
    except ExpressionError:
        return None


def in_unit(value: float, text: str) -> float:
    """A value in SI units in another unit, without the noise of computations."""
    factor = unit(text).factor
    return value if factor == 1 else neat(value / factor)


def neat(value: float) -> float:
    """A computed number with 12 digits, or 6 if the next three are noise, as the page rounds it."""
    certain = float(f"{value:.9g}")
    return certain if certain == float(f"{value:.6g}") else float(f"{value:.12g}")


def as_toml(value: Any) -> str:
    """A value as TOML.

    Raises
    ------
    ModelError
        Not a finite number, a short text, or a list or table of such values.
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float) and abs(value) < 1e300:
        return repr(value)
    if isinstance(value, str) and len(value) <= MAX_TEXT and value.isprintable():
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(as_toml, value)) + "]"
    if isinstance(value, dict) and all(isinstance(key, str) for key in value):
        names = [key if NAME.fullmatch(key) else as_toml(key) for key in value]
        entries = ", ".join(
            f"{name} = {as_toml(item)}" for name, item in zip(names, value.values(), strict=True)
        )
        return f"{{ {entries} }}" if entries else "{}"
    raise ModelError(f"{str(value)[:60]!r} is no value of a model file")
