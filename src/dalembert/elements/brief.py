"""Short representations of elements, points and results in one line."""

from __future__ import annotations

import dataclasses
from typing import Any

from dalembert.symbolic.formulas.expression import Expression, free_symbols

LONGEST = 120
"""Characters of a representation."""
FORMULA = 28
"""Characters of a formula in it."""


def brief(kind: str, name: str, parts: list[str]) -> str:
    """``<Kind 'name': part, part>``, cut where it grows too long.

    Examples
    --------
    >>> from dalembert.elements.brief import brief
    >>> brief("Spring", "k", ["stiffness=10 N/m", "free_length=0.5 m"])
    "<Spring 'k': stiffness=10 N/m, free_length=0.5 m>"
    """
    text, room = f"<{kind} {name!r}", LONGEST - len(kind) - len(name) - 8
    shown: list[str] = []
    for part in parts:
        if sum(map(len, shown)) + 2 * len(shown) + len(part) > room:
            shown.append("…")
            break
        shown.append(part)
    return f"{text}: {', '.join(shown)}>" if shown else f"{text}>"


def fields_of(element: Any) -> list[str]:
    """``field=value`` of what an element was given beside its name, without defaults and states."""
    found = []
    for field in dataclasses.fields(element):
        value = getattr(element, field.name, None)
        hidden = field.name == "name" or not field.init or value is None
        if hidden or _is_default(value, field.default):
            continue
        text = short(value, f"{element.name}.")
        if text:
            found.append(f"{field.name}={text}")
    return found


def short(value: Any, own: str = "") -> str:
    """A value in few characters; nothing for states, whose symbols begin with ``own``."""
    if isinstance(value, Expression):
        return _formula(value, own)
    if isinstance(value, (bool, int, float, str)):
        return repr(value)
    if isinstance(value, (tuple, list)) and value:
        return f"({', '.join(short(one, own) for one in value)})" if len(value) < 4 else ""
    if isinstance(value, dict):
        return f"({', '.join(map(str, value))})" if value else ""
    name = getattr(value, "name", None)
    if isinstance(name, str):
        return name or spot(value)
    return type(value).__name__


def spot(point: Any) -> str:
    """Where a point without a name is."""
    return f"{point.body.name}{_formula(point.local, '')}"


def _formula(value: Expression, own: str) -> str:
    if own and any(name.startswith(own) for name in free_symbols(value.sx)):
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
        given = [float(value.sx[k]) for k in range(value.sx.numel())]
        wanted = list(default) if isinstance(default, (tuple, list)) else [default]
        return given == wanted * (len(given) if len(wanted) == 1 else 1)
    return bool(type(value) is type(default) and value == default)
