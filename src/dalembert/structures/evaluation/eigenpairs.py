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
"""Displacements up to which all eigenpairs are found at once."""
NONE = 1e-11
"""Share of the largest one below which an eigenvalue of a matrix is round-off."""


def nearest(a, b, count: int, shift: float, solve: Solve) -> Pairs:
    """Eigenpairs nearest to a shift ``σ``, by increasing eigenvalue; ``B`` may be singular.

    Parameters
    ----------
    a, b : (f, f) sparse, symmetric; ``B`` positive semi-definite
    solve : of ``(A − σ B) x = y``

    Raises
    ------
    AnalysisError
        ``B`` is zero, or the iteration does not converge.
    """
    scale = np.sqrt(np.maximum(b.diagonal(), 0.0))
    if not scale.any():
        raise AnalysisError("nothing that can move has mass; give elements a density")
    if a.shape[0] <= DENSE:
        theta, vectors = _all_inverted(b, scale, solve)
    else:
        operator = scipy.sparse.linalg.LinearOperator(a.shape, solve, dtype=float)
        count = min(count, int((scale > 0).sum()) - 1)
        values, vectors = _iterated(a, count, M=b, sigma=shift, which="LM", OPinv=operator)
        theta, vectors = 1.0 / (values - shift), solve(b @ vectors)  # rids them of massless parts
    kept = np.argsort(-np.abs(theta), kind="stable")[:count]
    kept = kept[np.abs(theta[kept]) > NONE * np.abs(theta).max()]
    values = shift + 1.0 / theta[kept]
    order = np.argsort(values, kind="stable")
    return values[order], _normalised(vectors[:, kept[order]], b)


def _all_inverted(b, scale: np.ndarray, solve: Solve) -> Pairs:
    """All ``θ`` of ``(A − σ B)⁻¹ B`` that are not zero: with ``B = L Lᵀ`` those of
    ``Lᵀ (A − σ B)⁻¹ L``."""
    inverse = np.where(scale > 0, 1.0 / np.where(scale > 0, scale, 1.0), 0.0)
    squares, turned = np.linalg.eigh(inverse[:, None] * b.toarray() * inverse)
    some = squares > NONE * squares.max()
    root = scale[:, None] * turned[:, some] * np.sqrt(squares[some])
    flexible = solve(root)
    matrix = root.T @ flexible
    theta, y = np.linalg.eigh((matrix + matrix.T) / 2)
    if some.all():
        return theta, inverse[:, None] * turned / np.sqrt(squares) @ y
    return theta, flexible @ y


def largest(a, b, count: int, solve: Solve, both_signs: bool) -> Pairs:
    """Largest positive eigenvalues, falling; or the largest of both signs.

    Parameters
    ----------
    a, b : (f, f) sparse, symmetric; ``B`` positive definite
    solve : of ``B x = y``
    """
    if a.shape[0] <= DENSE:
        values, vectors = scipy.linalg.eigh(a.toarray(), b.toarray())
    else:
        operator = scipy.sparse.linalg.LinearOperator(a.shape, solve, dtype=float)
        which = "LM" if both_signs else "LA"
        values, vectors = _iterated(a, min(count, a.shape[0] - 1), M=b, Minv=operator, which=which)
    kept = np.abs(values) > NONE * np.abs(values).max(initial=0.0)
    if not both_signs:
        kept &= values > 0
    order = np.flatnonzero(kept)
    order = order[np.argsort(-np.abs(values[order]), kind="stable")][:count]
    return values[order], _normalised(vectors[:, order], b)


def _iterated(a, count: int, **options) -> Pairs:
    start = np.random.default_rng(0).standard_normal(a.shape[0])
    try:
        return scipy.sparse.linalg.eigsh(
            a, count, v0=start, ncv=min(a.shape[0], 2 * count + 20), **options
        )
    except scipy.sparse.linalg.ArpackError as error:
        raise AnalysisError(f"the search for eigenvalues failed ({error}); ask for fewer") from None


def _normalised(vectors: np.ndarray, b) -> np.ndarray:
    """``φᵀ B φ = 1``, and the largest entry positive (the first one of equals)."""
    vectors = vectors / np.sqrt(np.einsum("fk,fk->k", vectors, b @ vectors))
    largest = vectors[leading(vectors), np.arange(vectors.shape[1])]
    return vectors * np.where(largest < 0, -1.0, 1.0)
