"""Mean of a normal force over the penetrations of a step.

    f̄ = ∫ N(δ + s (δ⁺ − δ), δ̇) ds,    0 ≤ s ≤ 1,    N = 0 where δ ≤ 0

Its elastic part is ``(V(δ⁺) − V(δ))/(δ⁺ − δ)``, so that a step exchanges elastic energy exactly,
and its damping only dissipates (averaged vector field: Quispel & McLaren, J. Phys. A 41, 2008).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Force = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
"""Penetrations > 0 and their rates (n, m) → ``N``, ``∂N/∂δ``, ``∂N/∂δ̇``, all (n, m)."""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)
NODES, WEIGHTS = (1 + NODES) / 2, WEIGHTS / 2


@dataclass(frozen=True, eq=False)
class MeanForce:
    """Mean forces of n contacts.

    Attributes
    ----------
    value : (n,) ``f̄`` [N]
    by_end, by_rate : (n,) derivatives by ``δ⁺`` and by ``δ̇``, not negative
    """

    value: np.ndarray
    by_end: np.ndarray
    by_rate: np.ndarray


def mean_force(force: Force, start: np.ndarray, end: np.ndarray, rate: np.ndarray) -> MeanForce:
    """Mean forces from penetrations ``start`` to ``end`` (n,) at rates (n,).

    Gauss's rule in ``√δ`` from zero on is exact for powers 1, 3/2, 2 and 5/2 of the penetration.
    """
    roots = np.sqrt(np.maximum(start, 0.0)), np.sqrt(np.maximum(end, 0.0))
    inside = np.flatnonzero(roots[0] + roots[1] > 0)
    if not inside.size:
        return MeanForce(*np.zeros((3, start.size)))
    first, last = (root[inside, None] for root in roots)
    root = first + NODES * (last - first)
    weights = WEIGHTS * 2 * root / (first + last)
    fraction = NODES * (root + first) / (first + last)  # of the path
    values = force(root**2, np.broadcast_to(rate[inside, None], root.shape))
    crosses = (np.minimum(start, end) < 0)[inside]
    change = np.where(crosses, (end - start)[inside], 1.0)
    part = np.where(crosses, (last**2 - first**2)[:, 0] / change, 1.0)
    mean, by_rate = (part * (weights * value).sum(axis=1) for value in (values[0], values[2]))
    by_end = (weights * fraction * values[1]).sum(axis=1)
    at_end = force(np.where(last > 0, last, 1.0) ** 2, rate[inside, None])[0]
    jump = (np.where(last > 0, at_end, 0.0)[:, 0] - mean) / change
    result = np.zeros((3, start.size))
    result[:, inside] = mean, np.where(crosses, jump, by_end), by_rate
    return MeanForce(result[0], *np.maximum(result[1:], 0.0))
