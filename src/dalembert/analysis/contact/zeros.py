"""Zeros of guards in steps."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.analysis.events import locate

HALVINGS = 50
"""Upper limit of the halvings of a step that begins at a zero."""


def first_zero(value: Callable[[float], float], inside: float, longest: float) -> float | None:
    """The first zero of a function that is smooth only before it; None without a zero."""
    before = inside
    for k in range(HALVINGS - 1, -1, -1):
        length = inside + (longest - inside) * 2.0**-k
        if not value(length) > 0:
            return locate(value, before, length)
        before = length
    return None


def cubic(c, begin, end, slope, slope_end) -> np.ndarray:
    """Cubic Hermite interpolation at fractions ``c`` of steps by values and slopes at the ends."""
    values = (1 + 2 * c) * (1 - c) ** 2 * begin + c**2 * (3 - 2 * c) * end
    return values + c * (1 - c) ** 2 * slope - c**2 * (1 - c) * slope_end


def minimum_of_cubic(begin, end, slope, slope_end) -> np.ndarray:
    """Fraction of every step at the minimum of the cubic inside; the middle without one."""
    a = 6 * (begin - end) + 3 * (slope + slope_end)
    b = -6 * (begin - end) - 4 * slope - 2 * slope_end
    with np.errstate(all="ignore"):
        root = np.sqrt(b**2 - 4 * a * slope)
        fraction = np.where(b > 0, -2 * slope / (b + root), (root - b) / (2 * a))
    return np.where((fraction > 0) & (fraction < 1), fraction, 0.5)
