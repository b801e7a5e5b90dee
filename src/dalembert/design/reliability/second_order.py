"""Second-order corrections: the limit state bends at its design point.

In axes with the last along ``α`` the surface is ``u_n = β + Σ κ_i u_i²/2``. Breitung (1984):
``Φ(−β) Π(1 + βκ_i)^(−1/2)``; Tvedt (1983) adds two terms. The Hessian comes of central differences
of the exact gradient.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.design.reliability.distribution import density
from dalembert.design.reliability.first_order import DesignPoint, Search

STEP = 1e-4


@dataclass(frozen=True)
class SecondOrder:
    """Probabilities of failure by a limit state that bends.

    Attributes
    ----------
    curvatures : (n − 1,) ``κ``, above zero where the surface bends away from the origin
    breitung, tvedt : probability; NaN where the surface bends around the origin, ``1 + βκ ≤ 0``
    """

    curvatures: np.ndarray
    breitung: float
    tvedt: float


def second_order(search: Search, point: DesignPoint) -> SecondOrder:
    """The corrections at a design point, by two gradients for each random parameter but one."""
    curvatures = point.curvatures
    if curvatures is None:
        curvatures = principal_curvatures(search, point)
    return SecondOrder(curvatures, *corrected(point.beta, curvatures))


def principal_curvatures(search: Search, point: DesignPoint) -> np.ndarray:
    """(n − 1,) principal curvatures of the surface at a design point."""
    return principal_axes(search, point)[0]


def principal_axes(search: Search, point: DesignPoint) -> tuple[np.ndarray, np.ndarray]:
    """(n − 1,) eigenvalues of the Hessian across ``α`` over ``|∇G|``, and (n, n − 1) directions."""
    n = point.u.size
    full, _ = np.linalg.qr(np.column_stack([point.alpha, np.eye(n)]))
    across = full[:, 1:n]
    hessian = np.zeros((n - 1, n - 1))
    for k, direction in enumerate(across.T):
        low, high = (search.slope(point.u + s * direction)[0] for s in (-STEP, STEP))
        hessian[k] = across.T @ (high - low) / (2 * STEP)
    curvatures, axes = np.linalg.eigh((hessian + hessian.T) / 2 / point.slope)
    return curvatures, across @ axes


def corrected(beta: float, curvatures: np.ndarray) -> tuple[float, float]:
    """Probabilities of Breitung and of Tvedt."""
    from scipy.special import ndtr

    if np.any(1 + beta * curvatures <= 0):
        return np.nan, np.nan
    tail = float(ndtr(-beta))
    first = float(np.prod((1 + beta * curvatures) ** -0.5))
    breitung = tail * first
    if np.any(1 + (beta + 1) * curvatures <= 0):
        return breitung, np.nan
    rest = beta * tail - float(density(beta))
    second = rest * (first - float(np.prod((1 + (beta + 1) * curvatures) ** -0.5)))
    turned = np.prod((1 + (beta + 1j) * curvatures.astype(complex)) ** -0.5)
    third = (beta + 1) * rest * (first - float(np.real(turned)))
    return breitung, breitung + second + third
