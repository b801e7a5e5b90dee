"""How much to smooth: the L-curve, cross validation, or the noise that is known.

For a Jacobian ``J`` and rows ``P`` of a roughness, ``x_μ`` minimises ``|J x − y|² + μ |P x|²``. Too
small a ``μ`` follows the noise, too large a one the smoothness.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError

GRID = np.logspace(-10, 6, 161)
"""Smoothings, relative to the size of the Jacobian over that of the roughness."""


@dataclass(frozen=True)
class Curve:
    """Misfit and roughness over the smoothing, about one solution.

    Attributes
    ----------
    smoothing : (K,) ``μ``
    misfit, roughness : (K,) ``|J x − y|`` and ``|P x|``
    freedom : (K,) effective number of unknowns, the trace of the influence of the data
    samples : number of data
    """

    smoothing: np.ndarray
    misfit: np.ndarray
    roughness: np.ndarray
    freedom: np.ndarray
    samples: int


def curve(jacobian: np.ndarray, data: np.ndarray, penalty: np.ndarray) -> Curve:
    """The curve of a linear problem, by an eigenvalue problem of ``JᵀJ`` beside ``PᵀP``."""
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
    found = []
    for mu in GRID:
        filters = 1 / np.maximum(1 - shares + mu * shares, 1e-300)
        z = filters * seen
        found.append(
            (
                np.linalg.norm(rows @ z - data),
                np.linalg.norm(bent @ z),
                np.sum(filters * (1 - shares)),
            )
        )
    misfit, roughness, freedom = np.array(found).T
    return Curve(GRID * scale, misfit, roughness, freedom, data.size)


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
    """As smooth as the noise allows: residuals as large as the noise that was given (Morozov)."""
    allowed = np.flatnonzero(c.misfit <= np.sqrt(c.samples))
    if not allowed.size:
        raise AnalysisError(
            f"the residuals are at least {c.misfit.min() / np.sqrt(c.samples):.3g} times the noise "
            "given, however rough the histories; give more knots, or more noise"
        )
    return int(allowed[-1])


CHOICES: dict[str, Callable[[Curve], int]] = {
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
