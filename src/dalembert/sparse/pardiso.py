"""Factors by PARDISO of the Math Kernel Library, where ``pypardiso`` is installed.

Numbers of the options are those of its manual. Pivots are looked for within dense blocks only; what
it would have to change to go on is refused here, and left to who pivots freely.
"""

from __future__ import annotations

import os
import sys
from functools import cache
from pathlib import Path
from threading import Lock
from typing import Any
from weakref import finalize

import numpy as np
import scipy

from dalembert.sparse.solver import Factors

INDEFINITE, GENERAL = -2, 11
"""Kinds of real matrices."""
SMALLEST = 13
"""Pivots below ``10^-SMALLEST`` of the matrix are changed by PARDISO."""
ALIKE = 1e-13
"""Difference of opposite entries, relative to their diagonals, that is rounding."""


@cache
def available() -> bool:
    """Whether PARDISO can be used."""
    beside = sorted(Path(sys.prefix).glob("[Ll]ib*/*mkl_rt*"), key=lambda p: len(p.name))
    if beside:  # where pip puts it; else every folder of the installation is searched
        os.environ.setdefault("PYPARDISO_MKL_RT", str(beside[0]))
    try:
        import pypardiso

        found = pypardiso.PyPardisoSolver().libmkl
    except (ImportError, OSError):
        return False
    os.environ.setdefault("PYPARDISO_MKL_RT", found._name)  # or every solver looks for it anew
    return True


class PardisoFactors(Factors):
    """``P A Pᵀ = L D Lᵀ`` of a symmetric matrix, or ``L U`` (Schenk and Gärtner, 2004).

    Parameters
    ----------
    matrix : sparse, square

    Raises
    ------
    numpy.linalg.LinAlgError
        A pivot vanishes, or is too small to go on without pivoting freely.
    """

    name = "PARDISO"

    def __init__(self, matrix: Any):
        if not np.all(np.isfinite(matrix.data)):
            raise np.linalg.LinAlgError("not finite")
        self.scale = _scale(matrix)
        half = halved(matrix, self.scale)
        self.symmetric = half is not None
        if half is None:
            half, self.scale = scipy.sparse.csr_matrix(matrix), np.ones(matrix.shape[0])
        self._matrix, self._lock = half, Lock()
        self._solver = _prepared(self.symmetric)
        self._factorise()

    def _factorise(self) -> None:
        from pypardiso.pardiso_wrapper import PyPardisoError

        try:
            self._solver.factorize(self._matrix)
        except (PyPardisoError, ValueError) as error:
            raise np.linalg.LinAlgError(str(error)) from None
        finally:
            finalize(self, self._solver.free_memory, everything=True).atexit = False
        if self._solver.get_iparm(14):
            raise np.linalg.LinAlgError("pivots vanish")

    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        side = self.scale if rhs.ndim == 1 else self.scale[:, None]
        turned = trans == "T" and not self.symmetric
        with self._lock:  # one system at a time
            matrix = self._matrix.T if turned else self._matrix
            return side * self._solver.solve(matrix, np.asfortranarray(side * rhs, dtype=float))

    @property
    def negative(self) -> int:
        return int(self._solver.get_iparm(23))


def _scale(matrix: Any) -> np.ndarray:
    """Factors of rows and columns that make the diagonal one."""
    own = np.abs(matrix.diagonal())
    return 1.0 / np.sqrt(np.where(own > 0, own, 1.0))


def halved(matrix: Any, scale: np.ndarray) -> scipy.sparse.csr_matrix | None:
    """The scaled upper triangle of a symmetric matrix with all diagonal entries, by rows.

    Those of others are None.
    """
    whole = scipy.sparse.csc_matrix(matrix)
    whole.sort_indices()
    columns = np.repeat(np.arange(whole.shape[0], dtype=whole.indices.dtype), np.diff(whole.indptr))
    if np.count_nonzero(whole.indices == columns) < whole.shape[0]:
        return None
    entries = whole.data * scale[whole.indices] * scale[columns]
    full = scipy.sparse.csc_matrix((entries, whole.indices, whole.indptr), whole.shape)
    gap = full - full.T
    if not np.abs(gap.data).max(initial=0.0) <= ALIKE:
        return None
    below = whole.indices >= columns  # the lower triangle by columns is the upper one by rows
    starts = np.searchsorted(columns[below], np.arange(whole.shape[0] + 1)).astype(np.int32)
    return scipy.sparse.csr_matrix((entries[below], whole.indices[below], starts), whole.shape)


def _prepared(symmetric: bool) -> Any:
    from pypardiso import PyPardisoSolver

    solver = PyPardisoSolver(INDEFINITE if symmetric else GENERAL)
    solver.set_iparm(1, 1)  # none of the options below is left to PARDISO
    solver.set_iparm(2, 2)  # nested dissection
    solver.set_iparm(8, 0 if symmetric else 2)  # steps of refinement
    solver.set_iparm(10, SMALLEST)
    solver.set_iparm(11, 0 if symmetric else 1)  # scaling
    solver.set_iparm(13, 0 if symmetric else 1)  # large entries to the diagonal
    solver.set_iparm(21, 1)  # pivots of two rows
    return solver
