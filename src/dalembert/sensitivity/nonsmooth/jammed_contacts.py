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

from dalembert.sensitivity.nonsmooth.smallest_solution import SmallestSolution
from dalembert.sensitivity.nonsmooth.triplets import Sparse
from dalembert.sparse.factorise import SuperLUFactors

LARGEST = 1e12
"""Upper limit of the speeds by impulses, both scaled, where the equations of speeds are regular."""


class SmallestImpulses:
    """Solution of equations of speeds and impulses, and of the transposed ones.

    Parameters
    ----------
    matrix : with rows and columns of comparable size, compressed by columns
    impulses : (n,) mask of the impulses and of their conditions

    Raises
    ------
    numpy.linalg.LinAlgError
        The equations of the speeds are singular.
    """

    def __init__(self, matrix: Sparse, impulses: np.ndarray):
        own, rest = np.flatnonzero(impulses), np.flatnonzero(~impulses)
        self._own, self._rest = own, rest
        of_speeds, of_impulses = matrix[:, rest], matrix[:, own]
        self._factors = SuperLUFactors(of_speeds[rest])
        self._right, self._left = of_impulses[rest], of_speeds[own]
        moved = self._factors.solve(self._right.toarray())
        if not np.abs(moved).max(initial=0.0) <= LARGEST:
            raise np.linalg.LinAlgError("singular equations of speeds")
        schur = of_impulses[own].toarray() - self._left @ moved
        self._impulses = SmallestSolution(schur)

    def solve(self, right: np.ndarray, transposed: bool) -> np.ndarray:
        """Solution (n, c), the same linear map and its transpose."""
        left, over, trans = self._left, self._right, "N"
        if transposed:
            left, over, trans = over.T, left.T, "T"
        solution = np.zeros_like(right)
        rest = self._factors.solve(right[self._rest], trans)
        impulses = self._impulses(right[self._own] - left @ rest, transposed)
        solution[self._own] = impulses
        solution[self._rest] = rest - self._factors.solve(over @ impulses, trans)
        return solution
