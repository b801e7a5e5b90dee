"""Factors by SuperLU, which comes with SciPy."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy

from dalembert.errors import BudgetError
from dalembert.sparse.solver import Factors

SYMMETRIC = {"permc_spec": "MMD_AT_PLUS_A"}
"""Order for matrices whose pattern is symmetric."""
WITHOUT_PIVOTS = {**SYMMETRIC, "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
"""Diagonal pivots as they come, which keeps the factors sparse."""


class SuperLUFactors(Factors):
    """``P_r A P_c = L U`` (Demmel et al., SIAM J. Matrix Anal. Appl. 20, 1999).

    Parameters
    ----------
    matrix : sparse, square
    **how : options of ``scipy.sparse.linalg.splu``

    Raises
    ------
    numpy.linalg.LinAlgError
        A pivot vanishes.
    """

    name = "SuperLU"

    def __init__(self, matrix: Any, **how: Any):
        try:
            self._factors = scipy.sparse.linalg.splu(scipy.sparse.csc_array(matrix), **how)
        except RuntimeError as error:
            raise np.linalg.LinAlgError(str(error)) from None
        except MemoryError:
            raise BudgetError(
                f"the factors of {matrix.shape[0]} equations need more memory than there is; make "
                "it smaller, or take solver='iterative' where an analysis has that option"
            ) from None

    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        return self._factors.solve(rhs, trans)

    @property
    def negative(self) -> int:
        return int((self._factors.U.diagonal() < 0).sum())
