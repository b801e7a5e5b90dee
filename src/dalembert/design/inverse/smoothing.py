"""How much to smooth: likelihood, cross validation, the L-curve, or the noise that is known.

For a Jacobian ``J`` and rows ``P`` of a roughness, ``x_μ`` minimises ``|J x − y|² + μ |P x|²``. Too
small a ``μ`` follows the noise, too large a one the smoothness.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError

GRID = np.logspace(-10, 6, 161)
"""Smoothings, relative to the size of the Jacobian over that of the roughness."""


FIXED_POINTS = 200
"""Upper limit of iterations for the weights of several histories."""


@dataclass(frozen=True)
class Curve:
    """Misfit and roughness over the smoothing, about one solution.

    Attributes
    ----------
    smoothing : (K,) ``μ``
    misfit, roughness : (K,) ``|J x − y|`` and ``|P x|``
    freedom : (K,) effective number of unknowns, the trace of the influence of the data
    samples : number of data
    likelihood : (K,) −2 times the logarithm of the restricted likelihood, but for a constant
    """

    smoothing: np.ndarray
    misfit: np.ndarray
    roughness: np.ndarray
    freedom: np.ndarray
    samples: int
    likelihood: np.ndarray


def curve(jacobian: np.ndarray, data: np.ndarray, penalty: np.ndarray, known: bool) -> Curve:
    """The curve of a linear problem, by an eigenvalue problem of ``JᵀJ`` beside ``PᵀP``.

    The likelihood is that of a history whose roughness is a random variable, ``μ`` the ratio of the
    variances of noise and roughness, what has no roughness integrated out (Patterson and Thompson
    1971; Wahba 1985): ``d/σ² + log|JᵀJ + μPᵀP| − r log μ`` with ``d = |J x − y|² + μ|P x|²`` and
    ``r`` the rank of ``P``.

    Parameters
    ----------
    known : the variance ``σ²`` of the data is one; otherwise the most likely one is taken
    """
    from scipy.linalg import eigh

    information, rough = jacobian.T @ jacobian, penalty.T @ penalty
    scale = float(np.trace(information) / max(float(np.trace(rough)), 1e-300))
    # what neither sees keeps a trace of roughness, so that the pencil is definite
    both = information + scale * rough
    both += 1e-13 * np.trace(both) / len(both) * np.eye(len(both))
    shares, vectors = eigh(scale * rough, both)
    shares = np.clip(shares, 0.0, 1.0)  # of the roughness; 1 − share is that of the data
    seen = vectors.T @ (jacobian.T @ data)
    rows, bent = jacobian @ vectors, penalty @ vectors
    both_sizes = np.maximum(1 - shares + GRID[:, None] * shares, 1e-300)
    z = seen / both_sizes
    misfit = np.linalg.norm(z @ rows.T - data, axis=1)
    roughness = np.linalg.norm(z @ bent.T, axis=1)
    freedom = np.sum((1 - shares) / both_sizes, axis=1)
    rank = int(np.linalg.matrix_rank(penalty))
    deviance = np.maximum(misfit**2 + GRID * scale * roughness**2, 1e-300)
    left = max(data.size - (len(both) - rank), 1)
    fit = deviance if known else left * np.log(deviance)
    likelihood = fit + np.sum(np.log(both_sizes), axis=1) - rank * np.log(GRID)
    return Curve(GRID * scale, misfit, roughness, freedom, data.size, likelihood)


def balanced(
    jacobian: np.ndarray, data: np.ndarray, blocks: Sequence[np.ndarray], known: bool
) -> np.ndarray:
    """(m,) weights of the roughness of m histories, the first one, by their likelihood.

    Forces and moments differ in size and smoothness; one ``μ`` for all would be too large for some
    and too small for others. The fixed point of Fellner and Schall (Wood and Fasiolo 2017) is
    ``μ_j = σ² (r_j − μ_j tr(H⁻¹S_j))/(xᵀS_j x)``, ``H = JᵀJ + Σ μ_j S_j``.
    """
    information, seen = jacobian.T @ jacobian, jacobian.T @ data
    penalties = [block.T @ block for block in blocks]
    ranks = [int(np.linalg.matrix_rank(block)) for block in blocks]
    sizes = np.array(
        [
            np.trace(information[np.ix_(own, own)]) / np.trace(penalty)
            for penalty in penalties
            for own in [np.flatnonzero(np.diag(penalty))]
        ]
    )
    mu, left = 1e-2 * sizes, max(data.size - (len(seen) - sum(ranks)), 1)
    for _ in range(FIXED_POINTS):
        before = mu
        both = information + sum(m * s for m, s in zip(mu, penalties, strict=True))
        inverse = inverse_of(both)
        x = inverse @ seen
        rough = np.array([max(x @ s @ x, 1e-300) for s in penalties])
        used = np.array([np.sum(inverse * s) for s in penalties])
        deviance = float(np.sum((jacobian @ x - data) ** 2) + mu @ rough)
        level = 1.0 if known else deviance / left
        mu = level * np.maximum(np.array(ranks) - mu * used, 1e-6) / rough
        mu = np.clip(mu, GRID[0] * sizes, GRID[-1] * sizes)
        if np.all(abs(np.log(mu / before)) < 1e-3):
            break
    return np.sqrt(mu / mu[0])


def inverse_of(matrix: np.ndarray) -> np.ndarray:
    """Inverse of a symmetric matrix that need not be definite, whatever the units of its rows."""
    size = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    inverse = np.linalg.pinv(matrix / np.outer(size, size), hermitian=True)
    return np.asarray(inverse / np.outer(size, size))


def by_likelihood(c: Curve) -> int:
    """Most likely smoothing, that of restricted maximum likelihood (Wood 2011)."""
    return int(np.argmin(c.likelihood))


def by_curvature(c: Curve) -> int:
    """The corner of the L-curve, where it bends most (Hansen 1992)."""
    a, b = np.log(np.maximum(c.misfit, 1e-300)), np.log(np.maximum(c.roughness, 1e-300))
    s = np.log(c.smoothing)
    da, db = np.gradient(a, s), np.gradient(b, s)
    bend = da * np.gradient(db, s) - db * np.gradient(da, s)
    size = (da**2 + db**2) ** 1.5
    moving = size > 1e-3 * size.max()
    return int(np.argmax(np.where(moving, bend / np.maximum(size, 1e-300), -np.inf)))


def by_cross_validation(c: Curve) -> int:
    """Least error of each datum predicted by the others, on average (Golub, Heath and Wahba)."""
    left = np.maximum(c.samples - c.freedom, 1e-9 * c.samples)
    return int(np.argmin((c.misfit / left) ** 2))


def by_discrepancy(c: Curve) -> int:
    """As smooth as the noise allows: residuals as large as the noise that was given (Morozov).

    The smallest residuals may exceed their expectation by three of its standard deviations.
    """
    left = np.maximum(c.samples - c.freedom, 1.0)
    rough = int(np.argmin(c.misfit))
    excess = c.misfit[rough] ** 2 / left[rough]
    if excess > 1 + 3 * np.sqrt(2 / left[rough]):
        raise AnalysisError(
            f"the residuals are at least {c.misfit.min() / np.sqrt(c.samples):.3g} times the noise "
            "given, however rough the histories; give more knots, or more noise"
        )
    return int(np.flatnonzero(c.misfit**2 <= c.samples * max(excess, 1.0))[-1])


CHOICES: dict[str, Callable[[Curve], int]] = {
    "likelihood": by_likelihood,
    "l-curve": by_curvature,
    "cross-validation": by_cross_validation,
    "discrepancy": by_discrepancy,
}


def chosen(smoothing: str | float, c: Curve) -> float:
    """The smoothing: a number as it is, or by one of ``CHOICES``.

    Raises
    ------
    UnsupportedError
        There is no such choice.
    """
    if not isinstance(smoothing, str):
        return float(smoothing)
    if smoothing not in CHOICES:
        raise UnsupportedError(f"unknown smoothing {smoothing!r}; known: {', '.join(CHOICES)}")
    return float(c.smoothing[CHOICES[smoothing](c)])
