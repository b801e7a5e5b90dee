"""Checks of the values of export options, alike in all formats."""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Mapping
from typing import Any

from dalembert.errors import UnsupportedError


def _finite(value: Any) -> bool:
    number = isinstance(value, numbers.Real) and not isinstance(value, bool)
    return number and math.isfinite(value)


def _count(value: Any) -> bool:
    whole = isinstance(value, numbers.Integral) and not isinstance(value, bool)
    return whole and int(value) >= 2


def _names(value: Any) -> bool:
    several = isinstance(value, (list, tuple))
    return several and all(isinstance(name, str) for name in value)


VALUES: dict[str, tuple[Callable[[Any], bool], str]] = {
    "frames": (_count, "a whole number, at least 2"),
    "scale": (_finite, "a finite number"),
    "step": (lambda value: _finite(value) and value > 0, "a positive number of seconds"),
    "time": (_finite, "a finite number of seconds"),
    "trace": (_names, 'a list of points, such as ["coupler.end"]'),
}
"""Option → check of its value, and what is accepted."""


def check_values(owner: str, options: Mapping[str, Any]) -> None:
    """Refuse values that an option does not accept; None is the default of all.

    Raises
    ------
    UnsupportedError
        Names the option, its value and what is accepted.
    """
    for name, value in options.items():
        if value is None or name not in VALUES:
            continue
        valid, accepted = VALUES[name]
        if not valid(value):
            raise UnsupportedError(f"{owner}: {name} is {value!r:.60}; give {accepted}")
