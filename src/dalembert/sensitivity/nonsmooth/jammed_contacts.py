"""Equations of contacts that contradict each other, with the smallest impulses.

With slip, ``P_T = μ P_N d``, the impulses act along other directions than those of the conditions.
If contacts are redundant, combinations of impulses without an effect on the conditions may then
change speeds, so that changes that contradict the conditions have unlimited speeds. In

    [[A, B], [C, D]] (v, P) = (r, s)

``P = S⁺ (s − C A⁻¹ r)`` with the pseudoinverse of ``S = D − C A⁻¹ B``: impulses of least squares,
the smallest ones among these, which are bounded.
"""

from __future__ import annotations

import numpy as np
import scipy

from dalembert.sensitivity.nonsmooth.slope_function import Sparse

RANK = 1e-7
"""Threshold of singular values, relative to the largest one [-]."""


class SmallestImpulses:
    """Solution of equations of speeds and impulses, and of the transposed ones.

    Parameters
    ----------
    matrix : with rows and columns of comparable size
    impulses : (n,) mask of the impulses and of their conditions

    Raises
    ------
    numpy.linalg.LinAlgError
        The equations of the speeds are singular.
    """

    def __init__(self, matrix: Sparse, impulses: np.ndarray):
        dense, own, rest = matrix.toarray(), np.flatnonzero(impulses), np.flatnonzero(~impulses)
        self._own, self._rest = own, rest
        speeds = dense[np.ix_(rest, rest)]
        if np.linalg.matrix_rank(speeds) < rest.size:
            raise np.linalg.LinAlgError("singular equations of speeds")
        self._factors = scipy.linalg.lu_factor(speeds)
        self._right, self._left = dense[np.ix_(rest, own)], dense[np.ix_(own, rest)]
        moved = scipy.linalg.lu_solve(self._factors, self._right)
        schur = dense[np.ix_(own, own)] - self._left @ moved
        self._inverse = scipy.linalg.pinv(schur, rtol=RANK)

    def solve(self, right: np.ndarray, transposed: bool) -> np.ndarray:
        """Solution (n, c), the same linear map and its transpose."""
        inverse, left, over, trans = self._inverse, self._left, self._right, 0
        if transposed:
            inverse, left, over, trans = inverse.T, over.T, left.T, 1
        solution = np.zeros_like(right)
        rest = scipy.linalg.lu_solve(self._factors, right[self._rest], trans)
        impulses = inverse @ (right[self._own] - left @ rest)
        solution[self._own] = impulses
        solution[self._rest] = rest - scipy.linalg.lu_solve(self._factors, over @ impulses, trans)
        return solution
