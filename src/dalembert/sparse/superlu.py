"""Factors by SuperLU of SciPy."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy

from dalembert.errors import BudgetError
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
