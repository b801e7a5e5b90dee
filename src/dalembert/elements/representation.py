"""One-line representations of elements, points and results."""

from __future__ import annotations

import dataclasses
from typing import Any

from dalembert.symbolic.formulas.expression import Expression, free_symbols

LONGEST = 120
"""Upper limit of the length of a representation."""
FORMULA = 28
"""Upper limit of the length of a formula in it."""


def brief(kind: str, name: str, parts: list[str]) -> str:
    """``<Kind 'name': part, part>``, truncated to the limit.

    Examples
    --------
    >>> from dalembert.elements.representation import brief
    >>> brief("Spring", "k", ["stiffness=10 N/m", "free_length=0.5 m"])
    "<Spring 'k': stiffness=10 N/m, free_length=0.5 m>"
    """
    text, available = f"<{kind} {name!r}", LONGEST - len(kind) - len(name) - 8
    fitting: list[str] = []
    for part in parts:
        if sum(map(len, fitting)) + 2 * len(fitting) + len(part) > available:
            fitting.append("…")
            break
        fitting.append(part)
    return f"{text}: {', '.join(fitting)}>" if fitting else f"{text}>"


def fields_of(element: Any) -> list[str]:
    """``field=value`` for the arguments of an element except its name, defaults and states."""
    texts = []
    for field in dataclasses.fields(element):
        value = getattr(element, field.name, None)
        hidden = field.name == "name" or not field.init or value is None
        if hidden or _is_default(value, field.default):
            continue
        text = short(value, f"{element.name}.")
        if text:
            texts.append(f"{field.name}={text}")
    return texts


def short(value: Any, prefix: str = "") -> str:
    """A value in few characters; empty for states, whose symbols start with ``prefix``."""
    if isinstance(value, Expression):
        return _formula(value, prefix)
    if isinstance(value, (bool, int, float, str)):
        return repr(value)
    if isinstance(value, (tuple, list)) and value:
        return f"({', '.join(short(item, prefix) for item in value)})" if len(value) < 4 else ""
    if isinstance(value, dict):
        return f"({', '.join(map(str, value))})" if value else ""
    name = getattr(value, "name", None)
    if isinstance(name, str):
        return name or spot(value)
    return type(value).__name__


def spot(point: Any) -> str:
    """Body and coordinates of a point without a name."""
    return f"{point.body.name}{_formula(point.local, '')}"


def _formula(value: Expression, prefix: str) -> str:
    if prefix and any(name.startswith(prefix) for name in free_symbols(value.sx)):
        return ""
    parts = [_number(value.sx[k]) for k in range(value.sx.numel())]
    text = parts[0] if len(parts) == 1 else f"({', '.join(parts)})"
    text = text if len(text) <= FORMULA else f"{text[: FORMULA - 1]}…"
    return f"{text} {value.unit}".rstrip()


def _number(sx: Any) -> str:
    return f"{float(sx):.6g}" if sx.is_constant() else str(sx)


def _is_default(value: Any, default: Any) -> bool:
    if default is dataclasses.MISSING:
        return False
    if isinstance(value, Expression):
        if not value.sx.is_constant():
            return False
        numbers = [float(value.sx[k]) for k in range(value.sx.numel())]
        defaults = list(default) if isinstance(default, (tuple, list)) else [default]
        return numbers == defaults * (len(numbers) if len(defaults) == 1 else 1)
    return bool(type(value) is type(default) and value == default)
