"""Dead centres: folds of the solution curve of a driven mechanism.

At a dead centre the curve ``(y(s), t(s))`` of ``Φ(y, t) = 0`` turns back in time. Its point is a
regular root of the fold system ``Φ = 0, C n = 0, nᵀn = 1`` (Moore and Spence 1980), here in
coordinates, equations and times measured by their natural sizes.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.analysis.kinematics.kernel import KinematicsKernel
from dalembert.symbolic.equations.newton import Equations, NewtonSettings, Residual, solve

SETTINGS = NewtonSettings(tolerance=1e-13, slack=1e4, max_iterations=30)
TURNS = 1e-6
"""Part of ``Φ_t`` outside the range of ``C`` from which on the curve turns back."""


@dataclass(frozen=True)
class Fold:
    """A dead centre: its time, position and the displacement by which the mechanism still moves."""

    time: float
    y: np.ndarray
    direction: np.ndarray


def find_fold(
    kernel: KinematicsKernel, time: float, y: np.ndarray, p: np.ndarray, near: float
) -> Fold | None:
    """Fold nearest to a position just before it, by Newton's method.

    Parameters
    ----------
    kernel : KinematicsKernel
    time, y : last position reached
    near : how far away it may be [s]
    """
    system = FoldSystem(kernel, time, y, p, near)
    found = solve(system, system.start, SETTINGS)
    after, place, direction = system.split(found.x)
    if not found.accepted or abs(after) > near or not system.turns_back(found.x):
        return None
    return Fold(time + after, place, direction)


class FoldSystem(Equations[np.ndarray]):
    """Unknown are displacement from the last position, direction and time, all by natural sizes."""

    def __init__(
        self, kernel: KinematicsKernel, time: float, y: np.ndarray, p: np.ndarray, near: float
    ):
        self.driven, self.manifold, sizes = kernel.jacobian, kernel.e.manifold, kernel.e.scales
        self.time, self.y, self.p, self.n = time, y, p, sizes.displacements.size
        self.units = np.concatenate([sizes.displacements, sizes.displacements, [near]])
        self.rows = sizes.rows
        direction = np.linalg.svd(self._tangents(time, y)[0])[2][-1]
        self.start = np.concatenate([np.zeros(self.n), direction, [0.0]])
        self._system = self._compiled(direction)

    def _tangents(self, time: float, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """``C`` and ``Φ_t`` by natural sizes."""
        _, by_y, by_t = (a.full() for a in self.driven(time, y, self.p))
        unit = self.units[: self.n]
        return by_y * unit / self.rows[:, None], by_t.ravel() * self.units[-1] / self.rows

    def _compiled(self, direction: np.ndarray) -> ca.Function:
        n, z = self.n, ca.MX.sym("z", 2 * self.n + 1)
        moved = z * self.units
        place = self.manifold.going(self.y, moved[:n])
        phi, phi_y, _ = self.driven(self.time + moved[2 * n], place, self.p)
        residual = ca.vertcat(
            phi / self.rows,
            ca.mtimes(phi_y, moved[n : 2 * n]) / self.rows,
            ca.dot(ca.DM(direction), z[n : 2 * n]) - 1,
        )
        return ca.Function("fold", [z], [residual, ca.jacobian(residual, z)])

    def split(self, z: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Time after the last position, position and direction, in their units."""
        moved = z * self.units
        place = self.manifold.go(self.y, moved[: self.n])
        return float(moved[-1]), place, moved[self.n : -1]

    def residual(self, x: np.ndarray) -> Residual:
        return Residual(self._system(x)[0].full().ravel(), 1.0)

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        return -np.asarray(np.linalg.solve(self._system(x)[1].full(), residual.value))

    def turns_back(self, z: np.ndarray) -> bool:
        """At a fold ``Φ_t`` leaves the range of ``C``; at a branch point it stays in it."""
        after, y, _ = self.split(z)
        by_y, by_t = self._tangents(self.time + after, y)
        left = np.linalg.svd(by_y.T)[2][-1]
        return bool(abs(left @ by_t) > TURNS * np.linalg.norm(by_t))
