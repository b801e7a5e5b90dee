"""Directions in which gaps slide over surfaces, where these have to be found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

LOOKS = 48
"""Directions at which one gap is looked at; between two that differ in sign is another."""
STARTS = (0.0, np.pi / 3, -np.pi / 3, np.pi)
"""Of the search for several at once, from the directions without friction."""
SAME = 1e-6
"""Difference of angles that is none."""

Turned = Callable[[Sequence[float]], np.ndarray]
"""Angles of the gaps → slips across them, zero where all directions are right."""


def directions(turned: Turned, near: np.ndarray) -> list[np.ndarray]:
    """Angles at which every gap slides along its direction, or against it."""
    return _of_one(turned) if near.size == 1 else _of_several(turned, near)


def _of_one(turned: Turned) -> list[np.ndarray]:
    from scipy.optimize import brentq

    def value(angle: float) -> float:
        return float(turned([angle])[0])

    looks = np.linspace(0.0, 2 * np.pi, LOOKS + 1) + 0.01
    values, found = [value(angle) for angle in looks], []
    largest = np.nanmax(np.abs(values))
    for (a, f_a), (b, f_b) in pairwise(zip(looks, values, strict=True)):
        if f_a == 0.0:
            found.append(a)
        elif f_a * f_b < 0:
            root = float(brentq(value, a, b, xtol=1e-14, rtol=1e-14))
            if abs(value(root)) <= SAME * largest:  # no pole
                found.append(root)
    return [np.array([angle]) for angle in found]


def _of_several(turned: Turned, near: np.ndarray) -> list[np.ndarray]:
    from scipy.optimize import root

    found: list[np.ndarray] = []
    for start in STARTS:
        made = root(lambda angles: turned(list(angles)), near + start, tol=1e-13)
        if not (made.success and np.isfinite(made.x).all()):
            continue
        distances = [np.abs(np.exp(1j * made.x) - np.exp(1j * known)).max() for known in found]
        if not any(distance < SAME for distance in distances):
            found.append(made.x)
    return found
