"""Choice of the smoothing: likelihood, cross validation, L-curve or discrepancy principle.

For a Jacobian ``J`` and a roughness matrix ``P``, ``x_μ`` minimises ``|J x − y|² + μ |P x|²``. If
``μ`` is too small the solution follows the noise; if it is too large the solution is too smooth.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError

GRID = np.logspace(-10, 6, 161)
"""Values of the smoothing, relative to the ratio of the traces of ``JᵀJ`` and ``PᵀP``."""


FIXED_POINTS = 200
"""Upper limit of iterations for the weights of several histories."""


@dataclass(frozen=True)
class Curve:
    """Misfit and roughness over the smoothing, for the problem linearised at a solution.

    Attributes
    ----------
    smoothing : (K,) ``μ``
    misfit, roughness : (K,) ``|J x − y|`` and ``|P x|``
    freedom : (K,) effective number of unknowns, the trace of the influence of the data
    samples : number of data
    likelihood : (K,) −2 times the logarithm of the restricted likelihood, up to a constant
    """

    smoothing: np.ndarray
    misfit: np.ndarray
    roughness: np.ndarray
    freedom: np.ndarray
    samples: int
    likelihood: np.ndarray


def curve(jacobian: np.ndarray, data: np.ndarray, penalty: np.ndarray, noise_known: bool) -> Curve:
    """L-curve of a linear problem by the generalised eigenvalue problem of ``JᵀJ`` and ``PᵀP``.

    The likelihood assumes a random roughness, with the ratio ``μ`` of the variances of noise and
    roughness; components without roughness are integrated out (Patterson and Thompson 1971; Wahba
    1985): ``d/σ² + log|JᵀJ + μPᵀP| − r log μ`` with ``d = |J x − y|² + μ|P x|²`` and
    ``r`` the rank of ``P``.

    Parameters
    ----------
    noise_known : the variance ``σ²`` of the data is one; otherwise the most likely one is used
    """
    from scipy.linalg import eigh

    information, rough = jacobian.T @ jacobian, penalty.T @ penalty
    scale = float(np.trace(information) / max(float(np.trace(rough)), 1e-300))
    # a small multiple of the identity makes the pencil definite
    pencil = information + scale * rough
    pencil += 1e-13 * np.trace(pencil) / len(pencil) * np.eye(len(pencil))
    shares, vectors = eigh(scale * rough, pencil)
    shares = np.clip(shares, 0.0, 1.0)  # fraction of the roughness; 1 − share is that of the data
    projected_data = vectors.T @ (jacobian.T @ data)
    rows, roughness_rows = jacobian @ vectors, penalty @ vectors
    eigenvalues = np.maximum(1 - shares + GRID[:, None] * shares, 1e-300)
    z = projected_data / eigenvalues
    misfit = np.linalg.norm(z @ rows.T - data, axis=1)
    roughness = np.linalg.norm(z @ roughness_rows.T, axis=1)
    freedom = np.sum((1 - shares) / eigenvalues, axis=1)
    rank = int(np.linalg.matrix_rank(penalty))
    deviance = np.maximum(misfit**2 + GRID * scale * roughness**2, 1e-300)
    degrees = max(data.size - (len(pencil) - rank), 1)
    fit = deviance if noise_known else degrees * np.log(deviance)
    likelihood = fit + np.sum(np.log(eigenvalues), axis=1) - rank * np.log(GRID)
    return Curve(GRID * scale, misfit, roughness, freedom, data.size, likelihood)


def history_weights(
    jacobian: np.ndarray, data: np.ndarray, blocks: Sequence[np.ndarray], noise_known: bool
) -> np.ndarray:
    """(m,) weights of the roughness of m histories by maximum likelihood; the first is one.

    Forces and moments differ in size and smoothness; a common ``μ`` would be too large for
    some and too small for others. The fixed point of Fellner and Schall (Wood and Fasiolo 2017) is
    ``μ_j = σ² (r_j − μ_j tr(H⁻¹S_j))/(xᵀS_j x)``, ``H = JᵀJ + Σ μ_j S_j``.
    """
    information, projected_data = jacobian.T @ jacobian, jacobian.T @ data
    penalties = [block.T @ block for block in blocks]
    ranks = [int(np.linalg.matrix_rank(block)) for block in blocks]
    scales = np.array(
        [
            np.trace(information[np.ix_(own, own)]) / np.trace(penalty)
            for penalty in penalties
            for own in [np.flatnonzero(np.diag(penalty))]
        ]
    )
    mu, degrees = 1e-2 * scales, max(data.size - (len(projected_data) - sum(ranks)), 1)
    for _ in range(FIXED_POINTS):
        previous = mu
        normal_matrix = information + sum(m * s for m, s in zip(mu, penalties, strict=True))
        inverse = pseudo_inverse(normal_matrix)
        x = inverse @ projected_data
        roughness = np.array([max(x @ s @ x, 1e-300) for s in penalties])
        traces = np.array([np.sum(inverse * s) for s in penalties])
        deviance = float(np.sum((jacobian @ x - data) ** 2) + mu @ roughness)
        level = 1.0 if noise_known else deviance / degrees
        mu = level * np.maximum(np.array(ranks) - mu * traces, 1e-6) / roughness
        mu = np.clip(mu, GRID[0] * scales, GRID[-1] * scales)
        if np.all(abs(np.log(mu / previous)) < 1e-3):
            break
    return np.sqrt(mu / mu[0])


def pseudo_inverse(matrix: np.ndarray) -> np.ndarray:
    """Pseudo-inverse of a symmetric, possibly singular matrix, scaled by its diagonal."""
    size = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    inverse = np.linalg.pinv(matrix / np.outer(size, size), hermitian=True)
    return np.asarray(inverse / np.outer(size, size))


def by_likelihood(c: Curve) -> int:
    """Index of the restricted maximum likelihood (Wood 2011)."""
    return int(np.argmin(c.likelihood))


def by_curvature(c: Curve) -> int:
    """Index of the corner of the L-curve, its maximum curvature (Hansen 1992)."""
    a, b = np.log(np.maximum(c.misfit, 1e-300)), np.log(np.maximum(c.roughness, 1e-300))
    s = np.log(c.smoothing)
    da, db = np.gradient(a, s), np.gradient(b, s)
    numerator = da * np.gradient(db, s) - db * np.gradient(da, s)
    size = (da**2 + db**2) ** 1.5
    moving = size > 1e-3 * size.max()
    return int(np.argmax(np.where(moving, numerator / np.maximum(size, 1e-300), -np.inf)))


def by_cross_validation(c: Curve) -> int:
    """Index of the minimum generalised cross-validation error (Golub, Heath and Wahba)."""
    degrees = np.maximum(c.samples - c.freedom, 1e-9 * c.samples)
    return int(np.argmin((c.misfit / degrees) ** 2))


def by_discrepancy(c: Curve) -> int:
    """Index of the largest smoothing with residuals of the size of the noise (Morozov).

    The smallest residuals may exceed their expectation by three of its standard deviations.
    """
    degrees = np.maximum(c.samples - c.freedom, 1.0)
    roughest = int(np.argmin(c.misfit))
    excess = c.misfit[roughest] ** 2 / degrees[roughest]
    if excess > 1 + 3 * np.sqrt(2 / degrees[roughest]):
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


def select_smoothing(smoothing: str | float, c: Curve) -> float:
    """The smoothing: a number, or selected by one of ``CHOICES``.

    Raises
    ------
    UnsupportedError
        The choice is unknown.
    """
    if not isinstance(smoothing, str):
        return float(smoothing)
    if smoothing not in CHOICES:
        raise UnsupportedError(f"unknown smoothing {smoothing!r}; known: {', '.join(CHOICES)}")
    return float(c.smoothing[CHOICES[smoothing](c)])
