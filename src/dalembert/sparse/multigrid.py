"""Conjugate gradients with algebraic multigrid, for systems too large to be factored.

Smoothed aggregation with the rigid motions as near-null space (Vaněk, Mandel and Brezina, Computing
56, 1996), by ``pyamg``. Equations are grouped by node: constrained directions of a node get an
extra equation with the solution zero.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy

from dalembert.errors import AnalysisError
from dalembert.packages import optional_package
from dalembert.sparse.solver import SparseSolver

TOLERANCE = 1e-10
"""Upper limit of the residual relative to the right-hand side [-]."""
ROUNDING = 1e-14
"""Rounding error of the residual relative to its terms [-]."""
ITERATIONS = 500
"""Upper limit of iterations per solution."""
COARSEST = 300
"""Upper limit of equations on the coarsest level, solved by dense factors."""


class Multigrid(SparseSolver):
    """Iterative solver of ``A x = b`` with ``A`` symmetric positive definite.

    Parameters
    ----------
    matrix : sparse matrix of some of all displacements
    places : (n,) node · directions + direction of each displacement
    directions : number of directions per node
    motions : (n, k) rigid motions
    """

    name = "conjugate gradients, algebraic multigrid"

    def __init__(self, matrix: Any, places: np.ndarray, directions: int, motions: np.ndarray):
        self.matrix, self.iterations, self.residual = scipy.sparse.csr_matrix(matrix), 0, 0.0
        nodes, node = np.unique(places // directions, return_inverse=True)
        self._places = node * directions + places % directions
        self._size = nodes.size * directions
        blocks = self._blocks(directions)
        wide = np.zeros((self._size, motions.shape[1]))
        wide[self._places] = motions
        self._cycle = _hierarchy(blocks, wide).aspreconditioner(cycle="V")
        self._operator = scipy.sparse.linalg.LinearOperator(
            self.matrix.shape, self._precondition, dtype=float
        )

    def _blocks(self, directions: int) -> scipy.sparse.bsr_matrix:
        """The matrix with equations for all directions of its nodes."""
        entries = self.matrix.tocoo()
        extra = np.setdiff1d(np.arange(self._size), self._places)
        rows = np.concatenate([self._places[entries.row], extra])
        columns = np.concatenate([self._places[entries.col], extra])
        diagonal = np.full(extra.size, self.matrix.diagonal().mean())
        shape = (self._size, self._size)
        extended = scipy.sparse.csr_matrix(
            (np.concatenate([entries.data, diagonal]), (rows, columns)), shape
        )
        return extended.tobsr((directions, directions))

    def _precondition(self, residual: np.ndarray) -> np.ndarray:
        wide = np.zeros(self._size)
        wide[self._places] = residual.ravel()
        return self._cycle.matvec(wide)[self._places]

    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        """Solutions; ``trans`` has no effect, since the matrix is symmetric.

        Raises
        ------
        AnalysisError
            The iteration does not converge; reports the residual.
        """
        if rhs.ndim == 2:
            return np.stack([self.solve(column) for column in rhs.T], axis=1)
        solution, residual = self.attempt(rhs, TOLERANCE)
        if not residual <= 1:
            raise AnalysisError(
                f"conjugate gradients left a residual of {residual * TOLERANCE:.1e} of the load "
                f"after {self.iterations} iterations; use solver='direct'",
                residual * TOLERANCE,
            )
        self.residual = max(self.residual, residual * TOLERANCE)
        return solution

    def attempt(self, rhs: np.ndarray, tolerance: float) -> tuple[np.ndarray, float]:
        """Solution reached, and its residual relative to the tolerance."""
        size = float(np.linalg.norm(rhs))
        if not size > 0:
            return np.zeros_like(rhs), 0.0 if size == 0 else np.inf
        solution, last = np.zeros_like(rhs), size
        for _ in range(3):  # iterative refinement
            rest = rhs - self.matrix @ solution
            step, _ = scipy.sparse.linalg.cg(
                self.matrix,
                rest,
                rtol=0.0,
                atol=0.3 * tolerance * size,
                maxiter=ITERATIONS,
                M=self._operator,
                callback=self._count,
            )
            solution = solution + step
            residual = float(np.linalg.norm(rhs - self.matrix @ solution))
            terms = np.linalg.norm(abs(self.matrix) @ np.abs(solution))
            allowed = tolerance * size + ROUNDING * terms
            if not np.isfinite(residual) or residual <= allowed or residual > 0.5 * last:
                break
            last = residual
        return solution, float(residual / allowed)

    def _count(self, _: np.ndarray) -> None:
        self.iterations += 1


def available() -> bool:
    """True if ``pyamg`` is installed."""
    from importlib.util import find_spec

    return find_spec("pyamg") is not None


def _hierarchy(matrix: scipy.sparse.bsr_matrix, motions: np.ndarray) -> Any:
    pyamg = optional_package("pyamg", "solver='iterative'", "use solver='direct'")

    smoother = ("block_gauss_seidel", {"sweep": "symmetric"})
    return pyamg.smoothed_aggregation_solver(
        matrix,
        B=motions,
        strength=("symmetric", {"theta": 0.0}),
        smooth=("jacobi", {"weighting": "local"}),
        improve_candidates=None,
        presmoother=smoother,
        postsmoother=smoother,
        max_coarse=COARSEST,
    )
