"""Second-order reliability: corrections for the curvature of the limit state.

In axes with the last along ``α`` the surface is ``u_n = β + Σ κ_i u_i²/2``. Breitung (1984):
``Φ(−β) Π(1 + βκ_i)^(−1/2)``; Tvedt (1983) adds two terms. The Hessian is computed by central
differences of the exact gradient.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.design.reliability.distribution import density
from dalembert.design.reliability.first_order import DesignPoint, Search

STEP = 1e-4
"""Step of the central differences."""


@dataclass(frozen=True)
class SecondOrder:
    """Second-order probabilities of failure.

    Attributes
    ----------
    curvatures : (n − 1,) ``κ``, positive if the surface curves away from the origin
    breitung, tvedt : probabilities; NaN if the surface curves around the origin, ``1 + βκ ≤ 0``
    """

    curvatures: np.ndarray
    breitung: float
    tvedt: float


def second_order(search: Search, point: DesignPoint) -> SecondOrder:
    """Second-order probabilities at a design point, from 2(n − 1) gradients."""
    curvatures = point.curvatures
    if curvatures is None:
        curvatures = principal_curvatures(search, point)
    return SecondOrder(curvatures, *corrected_probabilities(point.beta, curvatures))


def principal_curvatures(search: Search, point: DesignPoint) -> np.ndarray:
    """(n − 1,) principal curvatures of the surface at a design point."""
    return principal_axes(search, point)[0]


def principal_axes(search: Search, point: DesignPoint) -> tuple[np.ndarray, np.ndarray]:
    """(n − 1,) principal curvatures ``κ`` normal to ``α``, and (n, n − 1) principal directions."""
    n = point.u.size
    basis, _ = np.linalg.qr(np.column_stack([point.alpha, np.eye(n)]))
    tangents = basis[:, 1:n]
    hessian = np.zeros((n - 1, n - 1))
    for k, direction in enumerate(tangents.T):
        low, high = (search.slope(point.u + s * direction)[0] for s in (-STEP, STEP))
        hessian[k] = tangents.T @ (high - low) / (2 * STEP)
    curvatures, axes = np.linalg.eigh((hessian + hessian.T) / 2 / point.slope)
    return curvatures, tangents @ axes


def corrected_probabilities(beta: float, curvatures: np.ndarray) -> tuple[float, float]:
    """Probabilities of Breitung and Tvedt."""
    from scipy.special import ndtr

    if np.any(1 + beta * curvatures <= 0):
        return np.nan, np.nan
    tail = float(ndtr(-beta))
    first = float(np.prod((1 + beta * curvatures) ** -0.5))
    breitung = tail * first
    if np.any(1 + (beta + 1) * curvatures <= 0):
        return breitung, np.nan
    factor = beta * tail - float(density(beta))
    second = factor * (first - float(np.prod((1 + (beta + 1) * curvatures) ** -0.5)))
    complex_product = np.prod((1 + (beta + 1j) * curvatures.astype(complex)) ** -0.5)
    third = (beta + 1) * factor * (first - float(np.real(complex_product)))
    return breitung, breitung + second + third
