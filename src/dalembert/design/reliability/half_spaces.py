"""Probabilities of unions and intersections of half-spaces ``αᵀu ≥ β``, ``u`` standard normal.

The union by importance sampling of one half-space at a time (Owen, Maximov and Chertkov 2019),
``P = Σ_k Φ(−β_k) E[1/N(u) | αₖᵀu ≥ β_k]`` with ``N`` the number of half-spaces that hold ``u``: its
relative error is bounded however small the probability is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.design.reliability.first_order import DesignPoint

SAMPLES = 2**14
"""Points of a scrambled Sobol sequence for each half-space."""


def union_of_half_spaces(points: Sequence[DesignPoint]) -> float:
    """Probability that one of them holds."""
    from scipy.special import ndtr

    if len(points) == 1:
        return points[0].probability
    alphas, betas = np.array([p.alpha for p in points]), np.array([p.beta for p in points])
    if len(betas) == 2:
        return float(ndtr(-betas).sum() - intersection_of_half_spaces(points))
    return float(sum(_share(alphas, betas, k) for k in range(len(betas))))


def _share(alphas: np.ndarray, betas: np.ndarray, k: int) -> float:
    """``Φ(−β_k) E[1/N(u) | αₖᵀu ≥ β_k]``."""
    from scipy.special import ndtr, ndtri
    from scipy.stats import qmc

    tail = ndtr(-betas[k])
    if not tail > 0:
        return 0.0
    basis = np.linalg.svd(alphas, full_matrices=False)[2]
    within = alphas @ basis.T
    uniform = qmc.Sobol(len(basis) + 1, rng=np.random.default_rng(k)).random(SAMPLES)
    uniform = np.clip(uniform, 1e-15, 1 - 1e-15)
    ahead = -ndtri(uniform[:, 0] * tail)
    u = ndtri(uniform[:, 1:])
    u += (ahead - u @ within[k])[:, None] * within[k]
    holds = u @ within.T >= betas
    holds[:, k] = True
    return float(tail * np.mean(1 / holds.sum(axis=1)))


def intersection_of_half_spaces(points: Sequence[DesignPoint]) -> float:
    """Probability that all of them hold."""
    from scipy.stats import multivariate_normal

    alphas = np.array([p.alpha for p in points])
    betas = np.array([p.beta for p in points])
    together = multivariate_normal(cov=alphas @ alphas.T, allow_singular=True)
    return float(together.cdf(-betas, rng=np.random.default_rng(0)))
