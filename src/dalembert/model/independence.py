"""Which rows of a matrix are independent, and which unit vectors complete them."""

from __future__ import annotations

import numpy as np

CLEARLY, BARELY = 0.05, 1e-6
"""Length that is left of a unit vector across the others, for it to be taken at first, and then."""


def independent_rows(matrix: np.ndarray, tolerance: float = 1e-8) -> list[int]:
    """Rows, in order, that do not depend linearly on the rows before them."""
    basis = np.zeros((matrix.shape[1], 0))
    kept = []
    for k, row in enumerate(matrix):
        norm = np.linalg.norm(row)
        if norm == 0 or not np.isfinite(norm):
            continue
        rest, size = _across(row / norm, basis)
        if size > tolerance:
            basis = np.column_stack([basis, rest])
            kept.append(k)
    return kept


def independent_units(matrix: np.ndarray, order: list[int]) -> list[int]:
    """Unit vectors, tried in order, that complete the rows of ``matrix`` to a basis."""
    n = matrix.shape[1]
    kept: list[int] = []
    basis = np.linalg.qr(matrix.T)[0] if matrix.shape[0] else np.zeros((n, 0))
    need = n - matrix.shape[0]
    for threshold in (CLEARLY, BARELY):
        for k in order:
            if len(kept) == need:
                return kept
            if k in kept:
                continue
            rest, size = _across(np.eye(n)[k], basis)
            if size > threshold:
                basis = np.column_stack([basis, rest])
                kept.append(k)
    return kept


def _across(vector: np.ndarray, basis: np.ndarray) -> tuple[np.ndarray, float]:
    """Direction and length of what is left of a vector across an orthonormal basis."""
    for _ in range(2):  # once leaves rounding of the size of the vector
        vector = vector - basis @ (basis.T @ vector)
    size = float(np.linalg.norm(vector))
    return (vector / size if size else vector), size
