"""Maps of a state by equations, as numbers: ``G(z, x, t, p) = 0``, ``x⁺ = F(z, x, t, p)``.

    dz = −G_z⁻¹ (G_x dx + G_t dt + G_p dp),      dx⁺ = F_z dz + F_x dx + F_t dt + F_p dp

``G_z`` may be singular where unknowns are not unique, as impulses of contacts that determine each
other: least changes are taken, for what is unique does not depend on them.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.errors import SingularityError

ROUNDS, SOLVED, LEFT = 20, 1e-11, 1e-6
"""Of Newton's method; residual that is zero, by its terms; share of a right side that may be
left."""


class ImplicitMap:
    """A map of one kind.

    Parameters
    ----------
    z, x, t, p : SX symbols
    fixed : SX symbols that nothing is differentiated by
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
        first = [ca.densify(each) for each in (equations, slopes[0])]
        self.size = z.numel()
        self._equations = ca.Function("equations", inputs, first, options)
        self._slopes = ca.Function(
            "slopes", inputs, [ca.densify(s) for s in (following, *slopes)], options
        )

    def at(self, z: np.ndarray, x: np.ndarray, t: float, p: np.ndarray, fixed: np.ndarray) -> MapAt:
        """The map at a state; unknowns are found from near ones."""
        z = z.copy()
        for _ in range(ROUNDS if self.size else 0):
            left, by_z = (e.full() for e in self._equations(z, x, t, p, fixed))
            terms = np.abs(by_z) @ np.abs(z) + np.abs(left.ravel())
            if np.all(np.abs(left.ravel()) <= SOLVED * terms.max(initial=1.0)):
                break
            z -= _solved(by_z, left).ravel()
        found = [s.full() for s in self._slopes(z, x, t, p, fixed)]
        return MapAt(z, found[0].ravel(), *found[1:])


@dataclass(frozen=True, eq=False)
class MapAt:
    """A map at one state, with its slopes.

    Attributes
    ----------
    z : unknowns
    following : ``x⁺``
    by_z, by_x, by_t, by_p : of ``G``
    z_then, x_then, t_then, p_then : of ``F``
    """

    z: np.ndarray
    following: np.ndarray
    by_z: np.ndarray
    by_x: np.ndarray
    by_t: np.ndarray
    by_p: np.ndarray
    z_then: np.ndarray
    x_then: np.ndarray
    t_then: np.ndarray
    p_then: np.ndarray

    def push(self, dx: np.ndarray, dt: float, dp: np.ndarray) -> np.ndarray:
        """Change (n, c) of what follows."""
        dz = -_solved(self.by_z, self.by_x @ dx + self.by_t * dt + self.by_p @ dp)
        return self.z_then @ dz + self.x_then @ dx + self.t_then * dt + self.p_then @ dp

    def pull(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the state and of the parameters, from those of what follows."""
        inner = -_solved(self.by_z.T, self.z_then.T @ weights)
        return (
            self.by_x.T @ inner + self.x_then.T @ weights,
            self.by_p.T @ inner + self.p_then.T @ weights,
        )


def _solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Least solution of equations that have one.

    Raises
    ------
    SingularityError
        They have none.
    """
    if not matrix.size:
        return np.zeros((matrix.shape[1], *right.shape[1:]))
    rows = 1 / np.maximum(np.abs(matrix).max(axis=1, keepdims=True), np.finfo(float).tiny)
    columns = 1 / np.maximum(np.abs(rows * matrix).max(axis=0), np.finfo(float).tiny)
    scaled, wanted = rows * matrix * columns, rows * right
    found = np.linalg.lstsq(scaled, wanted, rcond=1e-12)[0]
    left = np.abs(scaled @ found - wanted).max(initial=0.0)
    if not left <= LEFT * max(np.abs(wanted).max(initial=0.0), np.finfo(float).tiny):
        raise SingularityError(
            "impulses of contacts that determine each other have no derivative; let fewer touch"
        )
    return columns[:, None] * found
