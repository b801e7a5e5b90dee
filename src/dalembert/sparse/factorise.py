"""Which factors a matrix gets: PARDISO where it is installed and worth its while, or SuperLU."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.sparse import pardiso
from dalembert.sparse.pardiso import PardisoFactors
from dalembert.sparse.solver import Factors
from dalembert.sparse.superlu import SYMMETRIC, WITHOUT_PIVOTS, SuperLUFactors

WORTH = 20_000
"""Rows from which on PARDISO is faster than SuperLU, its start included."""


def symmetric_factors(matrix: Any) -> Factors:
    """Factors by symmetric elimination, of a matrix that is positive definite as a rule.

    Raises
    ------
    numpy.linalg.LinAlgError
        A pivot vanishes.
    """
    return _by_pardiso(matrix) or SuperLUFactors(matrix, **WITHOUT_PIVOTS)


def indefinite_factors(matrix: Any) -> Factors:
    """Factors with pivots, of a matrix whose pattern is symmetric.

    Raises
    ------
    numpy.linalg.LinAlgError
        It is singular.
    """
    return _by_pardiso(matrix) or pivoted_factors(matrix)


def pivoted_factors(matrix: Any) -> Factors:
    """The same with pivots from everywhere in a column.

    Raises
    ------
    numpy.linalg.LinAlgError
        It is singular.
    """
    return SuperLUFactors(matrix, **SYMMETRIC)


def general_factors(matrix: Any) -> Factors:
    """Factors with pivots, of any square matrix.

    Raises
    ------
    numpy.linalg.LinAlgError
        It is singular.
    """
    return _by_pardiso(matrix) or SuperLUFactors(matrix)


def _by_pardiso(matrix: Any) -> Factors | None:
    if matrix.shape[0] < WORTH or not pardiso.available():
        return None
    try:
        return PardisoFactors(matrix)
    except np.linalg.LinAlgError:  # SuperLU may still find pivots, or tells what is wrong
        return None
