"""Zeros of guards in steps, by their values and slopes at the ends or along the motion."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.analysis.events import locate

HALVINGS = 50
"""Of a step that begins at a zero, in search of its positive part."""


def first_zero(value: Callable[[float], float], inside: float, longest: float) -> float | None:
    """The first zero of a function that is known to be smooth before it only; None without one."""
    before = inside
    for k in range(HALVINGS - 1, -1, -1):
        length = inside + (longest - inside) * 2.0**-k
        if not value(length) > 0:
            return locate(value, before, length)
        before = length
    return None


def cubic(c, begin, end, slope, slope_end) -> np.ndarray:
    """Values at parts ``c`` of steps by values and slopes at their ends (Hermite)."""
    values = (1 + 2 * c) * (1 - c) ** 2 * begin + c**2 * (3 - 2 * c) * end
    return values + c * (1 - c) ** 2 * slope - c**2 * (1 - c) * slope_end


def lowest(begin, end, slope, slope_end) -> np.ndarray:
    """Part of every step at which the cubic is least inside; the middle where it is not."""
    a = 6 * (begin - end) + 3 * (slope + slope_end)
    b = -6 * (begin - end) - 4 * slope - 2 * slope_end
    with np.errstate(all="ignore"):
        root = np.sqrt(b**2 - 4 * a * slope)
        found = np.where(b > 0, -2 * slope / (b + root), (root - b) / (2 * a))
    return np.where((found > 0) & (found < 1), found, 0.5)
