"""Conjugate gradients with algebraic multigrid, for what is too large to be factored.

Smoothed aggregation with the rigid motions as near-null space (Vaněk, Mandel and Brezina, Computing
56, 1996), by ``pyamg``. Equations of one node stay together: its directions that are held get an
equation of their own, with the solution zero.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.sparse.solver import SparseSolver

TOLERANCE = 1e-10
"""Of the residual, relative to the right-hand side; or what rounding leaves of its terms."""
ROUNDING = 1e-14
ITERATIONS = 500
COARSEST = 300
"""Equations on the coarsest level, which is solved by dense factors."""


class Multigrid(SparseSolver):
    """``A x = b`` with ``A`` symmetric and positive definite.

    Parameters
    ----------
    matrix : sparse, of some of all displacements
    places : (n,) node · directions + direction of each of them
    directions : of a node
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
        others = np.setdiff1d(np.arange(self._size), self._places)
        rows = np.concatenate([self._places[entries.row], others])
        columns = np.concatenate([self._places[entries.col], others])
        own = np.full(others.size, self.matrix.diagonal().mean())
        shape = (self._size, self._size)
        whole = scipy.sparse.csr_matrix(
            (np.concatenate([entries.data, own]), (rows, columns)), shape
        )
        return whole.tobsr((directions, directions))

    def _precondition(self, rest: np.ndarray) -> np.ndarray:
        wide = np.zeros(self._size)
        wide[self._places] = rest.ravel()
        return self._cycle.matvec(wide)[self._places]

    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        """Solutions; symmetric, so that transposed systems are the same.

        Raises
        ------
        AnalysisError
            The residual does not become small; tells it.
        """
        if rhs.ndim == 2:
            return np.stack([self.solve(column) for column in rhs.T], axis=1)
        found, residual = self.attempt(rhs, TOLERANCE)
        if not residual <= 1:
            raise AnalysisError(
                f"conjugate gradients left a residual of {residual * TOLERANCE:.1e} of the load "
                f"after {self.iterations} iterations; take solver='direct'",
                residual * TOLERANCE,
            )
        self.residual = max(self.residual, residual * TOLERANCE)
        return found

    def attempt(self, rhs: np.ndarray, tolerance: float) -> tuple[np.ndarray, float]:
        """What is reached, and the residual as a share of what is allowed."""
        size = float(np.linalg.norm(rhs))
        if not size > 0:
            return np.zeros_like(rhs), 0.0 if size == 0 else np.inf
        found, start = np.zeros_like(rhs), size
        for _ in range(3):  # what rounding has left is a new right-hand side
            rest = rhs - self.matrix @ found
            step, _ = scipy.sparse.linalg.cg(
                self.matrix,
                rest,
                rtol=0.0,
                atol=0.3 * tolerance * size,
                maxiter=ITERATIONS,
                M=self._operator,
                callback=self._count,
            )
            found = found + step
            left = float(np.linalg.norm(rhs - self.matrix @ found))
            terms = np.linalg.norm(abs(self.matrix) @ np.abs(found))
            allowed = tolerance * size + ROUNDING * terms
            if not np.isfinite(left) or left <= allowed or left > 0.5 * start:
                break
            start = left
        return found, float(left / allowed)

    def _count(self, _: np.ndarray) -> None:
        self.iterations += 1


def available() -> bool:
    """Whether ``pyamg`` is installed."""
    from importlib.util import find_spec

    return find_spec("pyamg") is not None


def _hierarchy(matrix: scipy.sparse.bsr_matrix, motions: np.ndarray) -> Any:
    if not available():
        raise UnsupportedError(
            "solver='iterative' needs pyamg; pip install 'dalembert[sparse]', or take 'direct'"
        )
    from pyamg import smoothed_aggregation_solver

    smoother = ("block_gauss_seidel", {"sweep": "symmetric"})
    return smoothed_aggregation_solver(
        matrix,
        B=motions,
        strength=("symmetric", {"theta": 0.0}),
        smooth=("jacobi", {"weighting": "local"}),
        improve_candidates=None,
        presmoother=smoother,
        postsmoother=smoother,
        max_coarse=COARSEST,
    )
