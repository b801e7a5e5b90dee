"""Slip directions over surfaces as roots of the slips across them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

SAMPLES = 48
"""Number of sampled directions of one gap in the search for sign changes."""
STARTS = (0.0, np.pi / 3, -np.pi / 3, np.pi)
"""Offsets of the initial angles of several gaps from the directions without friction [rad]."""
SAME = 1e-6
"""Tolerance for equal directions, and for a root relative to the largest sample."""

CrossSlips = Callable[[Sequence[float]], np.ndarray]
"""Angles of the gaps → slips across these directions, zero at a solution."""


def directions(cross_slips: CrossSlips, near: np.ndarray) -> list[np.ndarray]:
    """Angles at which every gap slides along its direction or against it."""
    return _one_gap(cross_slips) if near.size == 1 else _several_gaps(cross_slips, near)


def _one_gap(cross_slips: CrossSlips) -> list[np.ndarray]:
    from scipy.optimize import brentq

    def value(angle: float) -> float:
        return float(cross_slips([angle])[0])

    samples = np.linspace(0.0, 2 * np.pi, SAMPLES + 1) + 0.01
    values, angles = [value(angle) for angle in samples], []
    largest = np.nanmax(np.abs(values))
    for (a, f_a), (b, f_b) in pairwise(zip(samples, values, strict=True)):
        if f_a == 0.0:
            angles.append(a)
        elif f_a * f_b < 0:
            root = float(brentq(value, a, b, xtol=1e-14, rtol=1e-14))
            if abs(value(root)) <= SAME * largest:  # no pole
                angles.append(root)
    return [np.array([angle]) for angle in angles]


def _several_gaps(cross_slips: CrossSlips, near: np.ndarray) -> list[np.ndarray]:
    from scipy.optimize import root

    solutions: list[np.ndarray] = []
    for start in STARTS:
        result = root(lambda angles: cross_slips(list(angles)), near + start, tol=1e-13)
        if not (result.success and np.isfinite(result.x).all()):
            continue
        distances = [
            np.abs(np.exp(1j * result.x) - np.exp(1j * solution)).max() for solution in solutions
        ]
        if not any(distance < SAME for distance in distances):
            solutions.append(result.x)
    return solutions
