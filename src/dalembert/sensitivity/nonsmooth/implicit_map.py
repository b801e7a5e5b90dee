"""Numerical implicit maps of a state: ``G(z, x, t, p) = 0``, ``x⁺ = F(z, x, t, p)``.

    dz = −G_z⁻¹ (G_x dx + G_t dt + G_p dp),      dx⁺ = F_z dz + F_x dx + F_t dt + F_p dp

``G_z`` may be singular if unknowns are not unique, as for impulses of redundant contacts. The
minimum-norm solution is used, since unique quantities do not depend on the choice.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.errors import SingularityError

MAX_ITERATIONS, SOLVED, REMAINDER = 20, 1e-11, 1e-6
"""Newton iterations; tolerance of the residual relative to its terms [-]; tolerance of the
remainder of a linear system relative to its right-hand side [-]."""


class ImplicitMap:
    """Implicit map as compiled functions.

    Parameters
    ----------
    z, x, t, p : SX symbols
    fixed : SX symbols without derivatives
    equations, following : SX, ``G`` and ``F``
    """

    def __init__(
        self,
        z: ca.SX,
        x: ca.SX,
        t: ca.SX,
        p: ca.SX,
        fixed: ca.SX,
        equations: ca.SX,
        following: ca.SX,
    ):
        inputs = [z, x, t, p, fixed]
        slopes = [ca.jacobian(out, by) for out in (equations, following) for by in (z, x, t, p)]
        options = {"cse": True}
        first = [ca.densify(out) for out in (equations, slopes[0])]
        self.size = z.numel()
        self._equations = ca.Function("equations", inputs, first, options)
        self._slopes = ca.Function(
            "slopes", inputs, [ca.densify(s) for s in (following, *slopes)], options
        )

    def at(self, z: np.ndarray, x: np.ndarray, t: float, p: np.ndarray, fixed: np.ndarray) -> MapAt:
        """The map at a state, with unknowns by Newton's method from the initial guess ``z``."""
        z = z.copy()
        for _ in range(MAX_ITERATIONS if self.size else 0):
            residual, by_z = (e.full() for e in self._equations(z, x, t, p, fixed))
            terms = np.abs(by_z) @ np.abs(z) + np.abs(residual.ravel())
            if np.all(np.abs(residual.ravel()) <= SOLVED * terms.max(initial=1.0)):
                break
            z -= _solve(by_z, residual).ravel()
        following, *slopes = (s.full() for s in self._slopes(z, x, t, p, fixed))
        return MapAt(z, following.ravel(), *slopes)


@dataclass(frozen=True, eq=False)
class MapAt:
    """Implicit map at one state, with its derivatives.

    Attributes
    ----------
    z : unknowns
    following : ``x⁺``
    by_z, by_x, by_t, by_p : derivatives of ``G``
    next_by_z, next_by_x, next_by_t, next_by_p : derivatives of ``F``
    """

    z: np.ndarray
    following: np.ndarray
    by_z: np.ndarray
    by_x: np.ndarray
    by_t: np.ndarray
    by_p: np.ndarray
    next_by_z: np.ndarray
    next_by_x: np.ndarray
    next_by_t: np.ndarray
    next_by_p: np.ndarray

    def push(self, dx: np.ndarray, dt: float, dp: np.ndarray) -> np.ndarray:
        """Change (n, c) of ``x⁺``."""
        dz = -_solve(self.by_z, self.by_x @ dx + self.by_t * dt + self.by_p @ dp)
        return self.next_by_z @ dz + self.next_by_x @ dx + self.next_by_t * dt + self.next_by_p @ dp

    def pull(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the state and of the parameters from those of ``x⁺``."""
        inner = -_solve(self.by_z.T, self.next_by_z.T @ weights)
        return (
            self.by_x.T @ inner + self.next_by_x.T @ weights,
            self.by_p.T @ inner + self.next_by_p.T @ weights,
        )


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Minimum-norm solution of consistent equations.

    Raises
    ------
    SingularityError
        The equations are inconsistent.
    """
    if not matrix.size:
        return np.zeros((matrix.shape[1], *right.shape[1:]))
    rows = 1 / np.maximum(np.abs(matrix).max(axis=1, keepdims=True), np.finfo(float).tiny)
    columns = 1 / np.maximum(np.abs(rows * matrix).max(axis=0), np.finfo(float).tiny)
    scaled, rhs = rows * matrix * columns, rows * right
    solution = np.linalg.lstsq(scaled, rhs, rcond=1e-12)[0]
    remainder = np.abs(scaled @ solution - rhs).max(initial=0.0)
    if not remainder <= REMAINDER * max(np.abs(rhs).max(initial=0.0), np.finfo(float).tiny):
        raise SingularityError(
            "impulses of redundant contacts have no derivative; use fewer simultaneous contacts"
        )
    return columns[:, None] * solution
