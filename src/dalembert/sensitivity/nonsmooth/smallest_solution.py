"""Least-squares solutions of minimum norm, by orthogonal factors with column pivoting.

With ``S P = Q [[R₁₁, R₁₂], [0, 0]]`` and an orthonormal basis ``N`` of the null space,

    S⁺ = (1 − N Nᵀ) P [[R₁₁⁻¹], [0]] Q₁ᵀ

(Golub & Van Loan, Matrix Computations, 2013, 5.5).
"""

from __future__ import annotations

import numpy as np
import scipy

RANK = 1e-7
"""Threshold of the diagonal entries of ``R``, relative to the largest one [-]."""
BLOCK = 32
"""Columns that LAPACK eliminates at once, for which its workspace has room."""


class SmallestSolution:
    """Pseudoinverse of a square matrix, and its transpose, applied to columns.

    Parameters
    ----------
    matrix : (n, n)
    """

    def __init__(self, matrix: np.ndarray):
        room = (matrix.shape[0] + 1) * BLOCK + 2 * matrix.shape[0]
        factors, order, self._scales, *_ = scipy.linalg.lapack.dgeqp3(matrix, lwork=room)
        diagonal = np.abs(factors.diagonal())
        rank = int(np.count_nonzero(diagonal > RANK * diagonal[0]))
        self._reflectors, self._order = factors, order - 1
        self._triangle = np.asfortranarray(factors[:rank, :rank])
        basis = np.zeros((order.size, order.size - rank))
        basis[self._order[:rank]] = -self._triangular(factors[:rank, rank:], 0)
        basis[self._order[rank:]] = np.eye(order.size - rank)
        self._null = np.linalg.qr(basis)[0]

    def __call__(self, right: np.ndarray, transposed: bool) -> np.ndarray:
        """``S⁺ b`` or ``(S⁺)ᵀ b`` of columns ``b`` (n, c)."""
        rank, basic = self._triangle.shape[0], np.zeros(right.shape)
        if transposed:
            inside = right - self._null @ (self._null.T @ right)
            basic[:rank] = self._triangular(inside[self._order[:rank]], 1)
            return self._rotated(basic, "N")
        rotated = self._rotated(right, "T")[:rank]
        basic[self._order[:rank]] = self._triangular(rotated, 0)
        return np.asarray(basic - self._null @ (self._null.T @ basic))

    def _triangular(self, right: np.ndarray, trans: int) -> np.ndarray:
        """``R₁₁⁻¹ b``, or that of the transpose."""
        if not right.size:
            return right
        return np.asarray(scipy.linalg.lapack.dtrtrs(self._triangle, right, trans=trans)[0])

    def _rotated(self, right: np.ndarray, trans: str) -> np.ndarray:
        """``Q b``, or ``Qᵀ b``."""
        room = BLOCK * (right.shape[1] + BLOCK + 1)
        parts = self._reflectors, self._scales, right
        return np.asarray(scipy.linalg.lapack.dormqr("L", trans, *parts, lwork=room)[0])
