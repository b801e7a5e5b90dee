"""Properties of eigenvalues ``A φ = λ B φ``, common to mechanisms and structures.

Coincidence, normalisation and residual. The solvers differ: the whole spectrum of a small
unsymmetric matrix, or some pairs of large symmetric matrices.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

COINCIDE = 1e-6
"""Relative distance below which eigenvalues count as coincident [-].

Rounding splits a defective pair by the square root of the machine accuracy."""
SPLIT = 100.0
"""Distance of coincident eigenvalues, in rounding errors of an eigenvalue [-]."""
EQUAL_WEIGHTS = 1e-7
"""Relative difference below which weights of coincident eigenvalues count as equal [-]."""
CONVERGED = 1e-6
"""Upper limit of the residual of converged eigenpairs [-]."""
EQUAL = 1e-6
"""Relative difference below which sizes of entries count as equal [-]."""


def coinciding(values: np.ndarray, sizes: np.ndarray | float) -> list[list[int]]:
    """Groups of coincident eigenvalues: connected components by distance.

    Parameters
    ----------
    values : (m,)
    sizes : (m,) or scalar, reference sizes of their errors: their magnitudes for symmetric
        matrices, ``error_sizes`` for others
    """
    reach = COINCIDE * np.broadcast_to(sizes, values.shape)
    groups: list[list[int]] = []
    for k, value in enumerate(values):

        def close(group: list[int], k: int = k, value: complex = value) -> bool:
            distances = np.abs(values[group] - value)
            return bool(np.any(distances <= np.maximum(reach[group], reach[k])))

        near = [group for group in groups if close(group)]
        groups = [group for group in groups if group not in near]
        groups.append(sorted([k, *(i for group in near for i in group)]))
    return groups


def error_sizes(
    matrix: np.ndarray, values: np.ndarray, left: np.ndarray, right: np.ndarray
) -> np.ndarray:
    """(m,) reference sizes of the errors of eigenvalues of an unsymmetric matrix.

    Rounding changes an eigenvalue by the size of the matrix times its condition
    ``|w| |τ| / |wᴴ τ|`` (J. H. Wilkinson, *The Algebraic Eigenvalue Problem*, 1965), both of the
    balanced matrix. This is the distance of a defective pair; slow modes among fast ones remain
    well separated.
    """
    from scipy.linalg import matrix_balance

    if not values.size:
        return np.zeros(0)
    balanced, (scale, _) = matrix_balance(matrix, permute=False, separate=True)
    lengths = (np.linalg.norm(v, axis=0) for v in (left * scale[:, None], right / scale[:, None]))
    overlap = np.abs(np.sum(left.conj() * right, axis=0))
    condition = np.prod(list(lengths), axis=0) / np.maximum(overlap, np.finfo(float).tiny)
    change = SPLIT * np.finfo(float).eps * np.linalg.norm(balanced) * condition
    largest: np.ndarray = np.minimum(np.abs(values).max(), change / COINCIDE)
    return np.maximum(np.abs(values), largest)


def weighed_differently(weights: np.ndarray, size: float) -> bool:
    """True if the weights of coincident eigenvalues differ, relative to ``size``."""
    return bool(np.abs(weights - weights.mean()).max() > EQUAL_WEIGHTS * size)


def coincidence(numbers: Sequence[int], value: str) -> str:
    """Message about coincident modes, by their numbers."""
    *first, last = map(str, numbers)
    single = f"mode {last} coincides with its conjugate"
    several = f"modes {', '.join(first)} and {last} coincide"
    return (
        f"{several if first else single} ({value}): one of several equal eigenvalues has no "
        "gradient, only their mean has"
    )


def leading(shapes: np.ndarray) -> np.ndarray:
    """(m,) index of the largest entry of each shape (n, m), the first of equals."""
    sizes = np.abs(shapes)
    largest: np.ndarray = sizes >= (1 - EQUAL) * sizes.max(axis=0, initial=0.0)
    return np.asarray(np.argmax(largest, axis=0))


def residual(a, b, values: np.ndarray, vectors: np.ndarray, size: float = 0.0) -> float:
    """Largest entry of ``A φ − λ B φ``, relative to the sum of the magnitudes of its terms.

    Parameters
    ----------
    size : lower limit of the magnitude of the terms; the size of the matrix if it is unsymmetric,
        which its errors are relative to
    """
    remainder = np.abs(a @ vectors - (b @ vectors) * values).max(axis=0, initial=0.0)
    terms = abs(a) @ abs(vectors) + (abs(b) @ abs(vectors)) * abs(values)
    return float((remainder / terms.max(axis=0, initial=max(size, 1e-300))).max(initial=0.0))
