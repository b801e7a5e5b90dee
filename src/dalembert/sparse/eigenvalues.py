"""What holds of eigenvalues of all matrices, ``A φ = λ B φ``, of mechanisms and of structures.

When they coincide, which entry of a shape tells its sign and size, and what is left of their
equation. Who finds them differs: the whole spectrum of a small matrix without symmetry, or some
pairs of large symmetric ones.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

COINCIDE = 1e-6
"""Distance, relative to their size, below which eigenvalues cannot be told apart.

Rounding splits a defective pair by the square root of the machine's accuracy."""
SPLIT = 100.0
"""By so many times what rounding does to an eigenvalue another one may be apart from it."""
ALIKE = 1e-7
"""Relative difference of what coinciding eigenvalues weigh that counts as none."""
CONVERGED = 1e-6
"""Largest residual of eigenpairs that counts as none."""
EQUAL = 1e-6
"""Relative difference of the sizes of entries that count as equally large."""


def coinciding(values: np.ndarray, sizes: np.ndarray | float) -> list[list[int]]:
    """Groups of eigenvalues in which each is next to another one.

    Parameters
    ----------
    values : (m,)
    sizes : (m,) or one for all, what their errors are relative to: their own sizes where matrices
        are symmetric, ``error_sizes`` where they are not
    """
    reach = COINCIDE * np.broadcast_to(sizes, values.shape)
    groups: list[list[int]] = []
    for k, value in enumerate(values):

        def close(group: list[int], k: int = k, value: complex = value) -> bool:
            apart = np.abs(values[group] - value)
            return bool(np.any(apart <= np.maximum(reach[group], reach[k])))

        near = [group for group in groups if close(group)]
        groups = [group for group in groups if group not in near]
        groups.append(sorted([k, *(i for group in near for i in group)]))
    return groups


def error_sizes(
    matrix: np.ndarray, values: np.ndarray, left: np.ndarray, right: np.ndarray
) -> np.ndarray:
    """(m,) what the errors of eigenvalues of a matrix without symmetry are relative to.

    Rounding moves one by the size of the matrix times its condition ``|w| |τ| / |wᴴ τ|`` (J. H.
    Wilkinson, *The Algebraic Eigenvalue Problem*, 1965), both of the balanced matrix. That is its
    distance from a partner with which it is defective; slow modes beside fast ones are well apart.
    """
    from scipy.linalg import matrix_balance

    if not values.size:
        return np.zeros(0)
    balanced, (scale, _) = matrix_balance(matrix, permute=False, separate=True)
    lengths = (np.linalg.norm(v, axis=0) for v in (left * scale[:, None], right / scale[:, None]))
    overlap = np.abs(np.sum(left.conj() * right, axis=0))
    condition = np.prod(list(lengths), axis=0) / np.maximum(overlap, np.finfo(float).tiny)
    moved = SPLIT * np.finfo(float).eps * np.linalg.norm(balanced) * condition
    largest: np.ndarray = np.minimum(np.abs(values).max(), moved / COINCIDE)
    return np.maximum(np.abs(values), largest)


def told_apart(weights: np.ndarray, size: float) -> bool:
    """Whether a response weighs coinciding eigenvalues differently, measured by a size."""
    return bool(np.abs(weights - weights.mean()).max() > ALIKE * size)


def coincidence(numbers: Sequence[int], value: str) -> str:
    """What is said of modes that coincide, by their numbers."""
    *others, last = map(str, numbers)
    alone = f"mode {last} coincides with its conjugate"
    several = f"modes {', '.join(others)} and {last} coincide"
    return (
        f"{several if others else alone} ({value}): one of several equal eigenvalues has no "
        "gradient, only their mean has"
    )


def leading(shapes: np.ndarray) -> np.ndarray:
    """(m,) entries of shapes (n, m) that are largest, the first of equals."""
    sizes = np.abs(shapes)
    found: np.ndarray = np.argmax(sizes >= (1 - EQUAL) * sizes.max(axis=0, initial=0.0), axis=0)
    return found


def residual(a, b, values: np.ndarray, vectors: np.ndarray, size: float = 0.0) -> float:
    """Largest entry of ``A φ − λ B φ``, relative to what its terms would add up to.

    Parameters
    ----------
    size : that terms have at least; of the whole matrix where it is not symmetric, for its errors
        are relative to that
    """
    left = np.abs(a @ vectors - (b @ vectors) * values).max(axis=0, initial=0.0)
    terms = abs(a) @ abs(vectors) + (abs(b) @ abs(vectors)) * abs(values)
    return float((left / terms.max(axis=0, initial=max(size, 1e-300))).max(initial=0.0))
