"""Cubic Hermite polynomials inside steps, by values and slopes at the ends.

Slopes are those by the fraction of a step: rates times the length of the step.
"""

from __future__ import annotations

import numpy as np


def cubic(c, begin, end, slope, slope_end) -> np.ndarray:
    """Values at fractions ``c`` of steps."""
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
