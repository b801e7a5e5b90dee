"""Sparse factorisation by PARDISO for large systems if installed, otherwise by SuperLU."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.sparse import pardiso
from dalembert.sparse.pardiso import PardisoFactors
from dalembert.sparse.solver import Factors
from dalembert.sparse.superlu import SYMMETRIC, WITHOUT_PIVOTS, SuperLUFactors

PARDISO_ROWS = 20_000
"""Threshold of the number of rows for PARDISO to be faster than SuperLU, including start-up."""


def symmetric_factors(matrix: Any) -> Factors:
    """Factors by symmetric elimination without pivoting, for positive definite matrices.

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
