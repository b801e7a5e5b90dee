"""Factors by PARDISO of the Math Kernel Library, if ``pypardiso`` is installed.

Options are numbered as in its manual. Pivoting is restricted to dense blocks; a matrix whose pivots
would have to be perturbed is rejected, so that a solver with full pivoting can be used.
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
"""Matrix types of PARDISO: real symmetric indefinite, real unsymmetric."""
PIVOT_EXPONENT = 13
"""Pivots below ``10^-PIVOT_EXPONENT`` relative to the matrix are perturbed by PARDISO."""
SYMMETRIC = 1e-13
"""Upper limit of the asymmetry of a symmetric matrix, relative to its diagonals [-]."""


@cache
def available() -> bool:
    """True if PARDISO can be used."""
    libraries = sorted(Path(sys.prefix).glob("[Ll]ib*/*mkl_rt*"), key=lambda p: len(p.name))
    if libraries:  # installed by pip; avoids a search of all folders of the installation
        os.environ.setdefault("PYPARDISO_MKL_RT", str(libraries[0]))
    try:
        import pypardiso

        library = pypardiso.PyPardisoSolver().libmkl
    except (ImportError, OSError):
        return False
    os.environ.setdefault("PYPARDISO_MKL_RT", library._name)  # avoids a search by every solver
    return True


class PardisoFactors(Factors):
    """``P A Pᵀ = L D Lᵀ`` of a symmetric matrix, or ``L U`` (Schenk and Gärtner, 2004).

    Parameters
    ----------
    matrix : sparse, square

    Raises
    ------
    numpy.linalg.LinAlgError
        A pivot vanishes, or is too small without full pivoting.
    """

    name = "PARDISO"

    def __init__(self, matrix: Any):
        if not np.all(np.isfinite(matrix.data)):
            raise np.linalg.LinAlgError("not finite")
        self.scale = _scale(matrix)
        half = upper_triangle(matrix, self.scale)
        self.symmetric = half is not None
        if half is None:
            half, self.scale = scipy.sparse.csr_matrix(matrix), np.ones(matrix.shape[0])
        self._matrix, self._lock = half, Lock()
        self._solver = _solver(self.symmetric)
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
        scale = self.scale if rhs.ndim == 1 else self.scale[:, None]
        transposed = trans == "T" and not self.symmetric
        with self._lock:  # one system at a time
            matrix = self._matrix.T if transposed else self._matrix
            return scale * self._solver.solve(matrix, np.asfortranarray(scale * rhs, dtype=float))

    @property
    def negative(self) -> int:
        return int(self._solver.get_iparm(23))


def _scale(matrix: Any) -> np.ndarray:
    """Scale factors of rows and columns for a unit diagonal."""
    diagonal = np.abs(matrix.diagonal())
    return 1.0 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))


def upper_triangle(matrix: Any, scale: np.ndarray) -> scipy.sparse.csr_matrix | None:
    """The scaled upper triangle of a symmetric matrix with all diagonal entries, by rows.

    None for other matrices.
    """
    whole = scipy.sparse.csc_matrix(matrix)
    whole.sort_indices()
    columns = np.repeat(np.arange(whole.shape[0], dtype=whole.indices.dtype), np.diff(whole.indptr))
    if np.count_nonzero(whole.indices == columns) < whole.shape[0]:
        return None
    entries = whole.data * scale[whole.indices] * scale[columns]
    full = scipy.sparse.csc_matrix((entries, whole.indices, whole.indptr), whole.shape)
    asymmetry = full - full.T
    if not np.abs(asymmetry.data).max(initial=0.0) <= SYMMETRIC:
        return None
    below = whole.indices >= columns  # the lower triangle by columns is the upper one by rows
    starts = np.searchsorted(columns[below], np.arange(whole.shape[0] + 1)).astype(np.int32)
    return scipy.sparse.csr_matrix((entries[below], whole.indices[below], starts), whole.shape)


def _solver(symmetric: bool) -> Any:
    from pypardiso import PyPardisoSolver

    solver = PyPardisoSolver(INDEFINITE if symmetric else GENERAL)
    solver.set_iparm(1, 1)  # no default options
    solver.set_iparm(2, 2)  # nested dissection
    solver.set_iparm(8, 0 if symmetric else 2)  # steps of iterative refinement
    solver.set_iparm(10, PIVOT_EXPONENT)
    solver.set_iparm(11, 0 if symmetric else 1)  # scaling
    solver.set_iparm(13, 0 if symmetric else 1)  # large entries to the diagonal
    solver.set_iparm(21, 1)  # Bunch–Kaufman pivoting
    return solver
