"""Invariant subspaces of coincident eigenvalues."""

from __future__ import annotations

import numpy as np

from dalembert.errors import SingularityError


def invariant_subspaces(
    matrix: np.ndarray, values: np.ndarray, group: list[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Bases ``V`` and ``W`` of the right and left subspaces of some eigenvalues, ``Wᴴ V = I``.

    Computed by ordered Schur decompositions, which are robust for defective eigenvalues.

    Raises
    ------
    SingularityError
        They cannot be separated from the other eigenvalues.
    """
    from scipy.linalg import schur

    centre = values[group].mean()
    inside = np.abs(values[group] - centre).max()
    rest = np.delete(values, group)
    outside = np.abs(rest - centre).min() if rest.size else inside + 2.0
    radius = (inside + outside) / 2

    def basis(of: np.ndarray, about: complex) -> np.ndarray:
        _, vectors, count = schur(of, "complex", sort=lambda s: abs(s - about) <= radius)
        if count != len(group):
            raise SingularityError(f"eigenvalues near s = {centre:.6g} 1/s cannot be separated")
        return vectors[:, :count]

    right, left = basis(matrix, centre), basis(matrix.conj().T, np.conj(centre))
    return right, left @ np.linalg.inv(right.conj().T @ left)
