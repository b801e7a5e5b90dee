"""Sparse factorisation by PARDISO for large systems if installed, otherwise by SuperLU."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy

from dalembert.errors import BudgetError
from dalembert.sparse import pardiso
from dalembert.sparse.pardiso import PardisoFactors
from dalembert.sparse.solver import Factors

SYMMETRIC = {"permc_spec": "MMD_AT_PLUS_A"}
"""Column ordering for matrices of symmetric pattern."""
WITHOUT_PIVOTS = {**SYMMETRIC, "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
"""Diagonal pivots without exchanges, which preserves sparsity."""


class SuperLUFactors(Factors):
    """``P_r A P_c = L U`` (Demmel et al., SIAM J. Matrix Anal. Appl. 20, 1999).

    Parameters
    ----------
    matrix : sparse, square
    **options : options of ``scipy.sparse.linalg.splu``

    Raises
    ------
    numpy.linalg.LinAlgError
        A pivot vanishes.
    """

    name = "SuperLU"

    def __init__(self, matrix: Any, **options: Any):
        try:
            self._factors = scipy.sparse.linalg.splu(scipy.sparse.csc_array(matrix), **options)
        except RuntimeError as error:
            raise np.linalg.LinAlgError(str(error)) from None
        except MemoryError:
            raise BudgetError(
                f"the factors of {matrix.shape[0]} equations need more memory than available; "
                "use a smaller model, or solver='iterative' for analyses with that option"
            ) from None

    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        return self._factors.solve(rhs, trans)

    @property
    def negative(self) -> int:
        return int((self._factors.U.diagonal() < 0).sum())


PARDISO_ROWS = 20_000
"""Threshold of the number of rows for PARDISO to be faster than SuperLU, including start-up."""


def symmetric_factors(matrix: Any) -> Factors:
    """Factors by symmetric elimination, usually of a positive definite matrix.

    Raises
    ------
    numpy.linalg.LinAlgError
        A pivot vanishes.
    """
    return _pardiso_factors(matrix) or SuperLUFactors(matrix, **WITHOUT_PIVOTS)


def indefinite_factors(matrix: Any) -> Factors:
    """Factors with pivoting, for matrices of symmetric pattern.

    Raises
    ------
    numpy.linalg.LinAlgError
        The matrix is singular.
    """
    return _pardiso_factors(matrix) or pivoted_factors(matrix)


def pivoted_factors(matrix: Any) -> Factors:
    """SuperLU factors with full column pivoting, for matrices of symmetric pattern.

    Raises
    ------
    numpy.linalg.LinAlgError
        The matrix is singular.
    """
    return SuperLUFactors(matrix, **SYMMETRIC)


def general_factors(matrix: Any) -> Factors:
    """Factors with pivoting, for any square matrix.

    Raises
    ------
    numpy.linalg.LinAlgError
        The matrix is singular.
    """
    return _pardiso_factors(matrix) or SuperLUFactors(matrix)


def _pardiso_factors(matrix: Any) -> Factors | None:
    if matrix.shape[0] < PARDISO_ROWS or not pardiso.available():
        return None
    try:
        return PardisoFactors(matrix)
    except np.linalg.LinAlgError:  # SuperLU may find pivots, or raises
        return None
