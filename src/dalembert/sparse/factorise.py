"""Factorisation: LAPACK for dense matrices, SuperLU, or PARDISO for large systems if installed."""

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


COLUMNS = 8
"""Number of columns that SuperLU solves at once. BLAS solves more of them in threads, whose start
takes longer than the solution where matrices are small or other programs use the processor."""


class SuperLUFactors(Factors):
    """``P_r A P_c = L U`` (Demmel et al., SIAM J. Matrix Anal. Appl. 20, 1999).

    Parameters
    ----------
    matrix : sparse, square
    **options : options of ``scipy.sparse.linalg.splu``

    Raises
    ------
    numpy.linalg.LinAlgError
        A pivot vanishes, or an entry is not finite.
    """

    name = "SuperLU"

    def __init__(self, matrix: Any, **options: Any):
        _refuse_infinite(matrix.data)
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
        if rhs.ndim == 1 or rhs.shape[1] <= COLUMNS:
            return self._factors.solve(rhs, trans)
        parts = np.split(rhs, range(COLUMNS, rhs.shape[1], COLUMNS), axis=1)
        return np.hstack([self._factors.solve(part, trans) for part in parts])

    @property
    def negative(self) -> int:
        return int((self._factors.U.diagonal() < 0).sum())


COLUMNWISE = 500_000
"""Number of multiplications up to which columns are solved one by one. LAPACK solves several in
threads, whose start takes milliseconds where other programs use the processor."""


class DenseFactors(Factors):
    """``P A = L U`` of a dense matrix by LAPACK.

    Parameters
    ----------
    matrix : (n, n), possibly empty

    Raises
    ------
    numpy.linalg.LinAlgError
        A pivot vanishes, or an entry is not finite.
    """

    name = "LAPACK"

    def __init__(self, matrix: np.ndarray):
        _refuse_infinite(matrix)
        if not matrix.size:
            return
        self._factors, self._pivots, vanishing = scipy.linalg.lapack.dgetrf(matrix)
        if vanishing:
            raise np.linalg.LinAlgError("singular")

    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        if not rhs.size:
            return rhs
        solve, transposed = scipy.linalg.lapack.dgetrs, int(trans == "T")
        if rhs.ndim == 2 and rhs.shape[0] * rhs.size <= COLUMNWISE:
            columns = np.empty(rhs.shape, order="F")
            for k in range(rhs.shape[1]):
                columns[:, k] = solve(self._factors, self._pivots, rhs[:, k], transposed)[0]
            return columns
        return np.asarray(solve(self._factors, self._pivots, rhs, transposed)[0])

    @property
    def negative(self) -> int:
        return int((self._factors.diagonal() < 0).sum())


def _refuse_infinite(entries: np.ndarray) -> None:
    if not np.isfinite(entries).all():
        raise np.linalg.LinAlgError("not finite")


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
    """Factors with pivoting, for any square matrix, sparse or dense.

    Raises
    ------
    numpy.linalg.LinAlgError
        The matrix is singular or not finite.
    """
    if not matrix.shape[0]:
        return DenseFactors(np.zeros((0, 0)))
    if not scipy.sparse.issparse(matrix):
        return DenseFactors(matrix)
    return _pardiso_factors(matrix) or SuperLUFactors(matrix)


def _pardiso_factors(matrix: Any) -> Factors | None:
    if matrix.shape[0] < PARDISO_ROWS or not pardiso.available():
        return None
    try:
        return PardisoFactors(matrix)
    except np.linalg.LinAlgError:  # SuperLU may find pivots, or raises
        return None
