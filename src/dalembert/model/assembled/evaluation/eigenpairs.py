"""Some eigenpairs of symmetric sparse matrices, ``A φ = λ B φ``."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from dalembert.errors import AnalysisError
from dalembert.sparse.eigenvalues import leading

Solve = Callable[[np.ndarray], np.ndarray]
Pairs = tuple[np.ndarray, np.ndarray]

DENSE = 200
"""Upper limit of the number of displacements for dense eigensolvers."""
NONE = 1e-11
"""Threshold below which an eigenvalue is round-off, relative to the largest one."""


def nearest(a, b, count: int, shift: float, solve: Solve) -> Pairs:
    """Eigenpairs nearest to a shift ``σ``, by increasing eigenvalue; ``B`` may be singular.

    Parameters
    ----------
    a, b : (f, f) sparse, symmetric; ``B`` positive semi-definite
    solve : solver of ``(A − σ B) x = y``

    Raises
    ------
    AnalysisError
        ``B`` is zero, or the iteration does not converge.
    """
    scale = np.sqrt(np.maximum(b.diagonal(), 0.0))
    if not scale.any():
        raise AnalysisError("no free displacement has mass; give elements a density")
    if a.shape[0] <= DENSE:
        theta, vectors = _all_inverted(b, scale, solve)
    else:
        operator = scipy.sparse.linalg.LinearOperator(a.shape, solve, dtype=float)
        count = min(count, int((scale > 0).sum()) - 1)
        values, vectors = _iterated(a, count, M=b, sigma=shift, which="LM", OPinv=operator)
        theta, vectors = 1.0 / (values - shift), solve(b @ vectors)  # removes massless components
    selected = np.argsort(-np.abs(theta), kind="stable")[:count]
    selected = selected[np.abs(theta[selected]) > NONE * np.abs(theta).max()]
    values = shift + 1.0 / theta[selected]
    order = np.argsort(values, kind="stable")
    return values[order], _normalised(vectors[:, selected[order]], b)


def _all_inverted(b, scale: np.ndarray, solve: Solve) -> Pairs:
    """All nonzero ``θ`` of ``(A − σ B)⁻¹ B``: with ``B = L Lᵀ`` those of
    ``Lᵀ (A − σ B)⁻¹ L``."""
    inverse = np.where(scale > 0, 1.0 / np.where(scale > 0, scale, 1.0), 0.0)
    squares, axes = np.linalg.eigh(inverse[:, None] * b.toarray() * inverse)
    nonzero = squares > NONE * squares.max()
    root = scale[:, None] * axes[:, nonzero] * np.sqrt(squares[nonzero])
    flexible = solve(root)
    matrix = root.T @ flexible
    theta, y = np.linalg.eigh((matrix + matrix.T) / 2)
    if nonzero.all():
        return theta, inverse[:, None] * axes / np.sqrt(squares) @ y
    return theta, flexible @ y


def largest(a, b, count: int, solve: Solve, both_signs: bool) -> Pairs:
    """Largest positive eigenvalues in decreasing order, or the largest of both signs.

    Parameters
    ----------
    a, b : (f, f) sparse, symmetric; ``B`` positive definite
    solve : solver of ``B x = y``
    """
    if a.shape[0] <= DENSE:
        values, vectors = scipy.linalg.eigh(a.toarray(), b.toarray())
    else:
        operator = scipy.sparse.linalg.LinearOperator(a.shape, solve, dtype=float)
        which = "LM" if both_signs else "LA"
        values, vectors = _iterated(a, min(count, a.shape[0] - 1), M=b, Minv=operator, which=which)
    significant = np.abs(values) > NONE * np.abs(values).max(initial=0.0)
    if not both_signs:
        significant &= values > 0
    order = np.flatnonzero(significant)
    order = order[np.argsort(-np.abs(values[order]), kind="stable")][:count]
    return values[order], _normalised(vectors[:, order], b)


def _iterated(a, count: int, **options) -> Pairs:
    start = np.random.default_rng(0).standard_normal(a.shape[0])
    try:
        return scipy.sparse.linalg.eigsh(
            a, count, v0=start, ncv=min(a.shape[0], 2 * count + 20), **options
        )
    except scipy.sparse.linalg.ArpackError as error:
        raise AnalysisError(f"the search for eigenvalues failed ({error}); request fewer") from None


def _normalised(vectors: np.ndarray, b) -> np.ndarray:
    """``φᵀ B φ = 1``, and the largest entry positive (the first one of equals)."""
    vectors = vectors / np.sqrt(np.einsum("fk,fk->k", vectors, b @ vectors))
    largest = vectors[leading(vectors), np.arange(vectors.shape[1])]
    return vectors * np.where(largest < 0, -1.0, 1.0)
