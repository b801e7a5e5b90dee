"""The worst point of a limit state at a given index: ``min G(u)`` on ``|u| = β``.

The iteration of Wu, Millwater and Cruse (1990), ``u = −β ∇G/|∇G|``, halved towards where it was
until ``G`` falls, along the sphere.
"""

from __future__ import annotations

import numpy as np

from dalembert.design.reliability.first_order import Search

HALVINGS = 30


def worst_point(search: Search, beta: float, start: np.ndarray) -> tuple[np.ndarray, float]:
    """The point and ``G`` there.

    Raises
    ------
    AnalysisError
        A run fails.
    """
    u = start if np.linalg.norm(start) else np.zeros(search.nataf.size)
    g = search.needed(u)
    for _ in range(search.max_iterations):
        slope = search.slope(u)[0]
        size = float(np.linalg.norm(slope))
        if not size > 0:  # nothing random changes it
            return u, g
        aim = -beta * slope / size
        if np.linalg.norm(aim - u) <= search.tolerance**0.5 * beta:
            return aim, search.needed(aim)
        following, value = _fallen(search, u, g, aim, beta)
        if value >= g - search.tolerance * abs(g) and np.linalg.norm(u) > 0:
            return (following, value) if value < g else (u, g)
        u, g = following, value
    return u, g


def _fallen(
    search: Search, u: np.ndarray, g: float, aim: np.ndarray, beta: float
) -> tuple[np.ndarray, float]:
    """On the way to ``aim`` along the sphere, the first of halved steps at which ``G`` is less."""
    if not np.linalg.norm(u):
        return aim, search.needed(aim)
    share = 1.0
    for _ in range(HALVINGS):
        between = u + share * (aim - u)
        size = float(np.linalg.norm(between))
        if size > 1e-12:
            there = beta * between / size
            value = search.value(there)
            if np.isfinite(value) and value < g:
                return there, value
        share /= 2
    return u, g
