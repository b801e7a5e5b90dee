"""Singular positions of a driven mechanism: branch points and dead centres.

At a branch point branches of the motion intersect. The motion is smooth there, and the determinant
of the Jacobian ``C`` changes its sign. At a dead centre the curve ``(y(s), t(s))`` of ``Φ(y, t) =
0`` turns back in time. The point is a regular root of the fold system ``Φ = 0, C n = 0, nᵀn = 1``
(Moore and Spence 1980), here in coordinates, equations and times relative to their natural sizes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.analysis.kinematics.kernel import KinematicsKernel
from dalembert.symbolic.equations.newton import Equations, NewtonSettings, Residual, solve

MANY = 400
"""Upper limit of the number of displacements for which determinants are computed."""
SETTINGS = NewtonSettings(tolerance=1e-13, slack=1e4, max_iterations=30)
"""Newton settings of the fold system."""
TURNS = 1e-6
"""Threshold for a fold: part of ``Φ_t`` outside the range of ``C``."""


class BranchPoints:
    """Branch points between the positions of a motion.

    Parameters
    ----------
    kernel : KinematicsKernel
    p : (np,) parameters
    times : (k,) of the positions
    table : (n, k) configurations of the kernel
    """

    def __init__(
        self, kernel: KinematicsKernel, p: np.ndarray, times: np.ndarray, table: np.ndarray
    ):
        self.kernel, self.p, self.times, self.table = kernel, p, times, table
        self.n = kernel.e.coordinate_count

    def __iter__(self) -> Iterator[tuple[float, np.ndarray]]:
        """Time and position of each branch point."""
        if self.times.size < 2 or self.kernel.e.scales.displacements.size > MANY:
            return
        signs = self._signs()
        for k in np.flatnonzero(signs[:-1] * signs[1:] < 0):
            time = self._locate(int(k))
            yield time, self._position(int(k), time)

    def _signs(self) -> np.ndarray:
        """(k,) signs of the determinants."""
        mapped, n = self.kernel.jacobian.map(self.times.size), self.kernel.e.speed_count
        p = np.tile(self.p[:, None], self.times.size)
        flat = np.asarray(mapped(self.times, self.table[: self.n], p)[1].full())
        return np.linalg.slogdet(flat.reshape(n, self.times.size, n).transpose(1, 0, 2))[0]

    def _position(self, k: int, time: float) -> np.ndarray:
        """The position at a time between two columns of the table."""
        step = time - self.times[k]
        new = self.kernel.single(self.table[:, k], time, step, self.p).full().ravel()
        return new[: self.n]

    def _locate(self, k: int) -> float:
        """Time of the change of sign, by bisection [s]."""
        low, high = self.times[k], self.times[k + 1]
        rounding = 1e-13 * max(abs(self.times[0]), abs(self.times[-1]))
        first = np.linalg.slogdet(self._jacobian(low, self.table[: self.n, k]))[0]
        for _ in range(60):
            middle = (low + high) / 2
            jacobian = self._jacobian(middle, self._position(k, middle))
            if not np.all(np.isfinite(jacobian)):
                break
            here = np.linalg.slogdet(jacobian)[0]
            low, high = (middle, high) if here == first else (low, middle)
            if high - low < rounding:
                break
        return float((low + high) / 2)

    def _jacobian(self, time: float, y: np.ndarray) -> np.ndarray:
        return self.kernel.jacobian(time, y, self.p)[1].full()


@dataclass(frozen=True)
class Fold:
    """A dead centre: time, position and direction of the remaining motion."""

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
    near : upper limit of the distance in time [s]
    """
    system = FoldSystem(kernel, time, y, p, near)
    root = solve(system, system.start, SETTINGS)
    after, position, direction = system.split(root.x)
    if not root.accepted or abs(after) > near or not system.turns_back(root.x):
        return None
    return Fold(time + after, position, direction)


class FoldSystem(Equations[np.ndarray]):
    """Fold system in the displacement from the last position, direction and time."""

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
        """``C`` and ``Φ_t`` relative to natural sizes."""
        _, by_y, by_t = (a.full() for a in self.driven(time, y, self.p))
        unit = self.units[: self.n]
        return by_y * unit / self.rows[:, None], by_t.ravel() * self.units[-1] / self.rows

    def _compiled(self, direction: np.ndarray) -> ca.Function:
        n, z = self.n, ca.MX.sym("z", 2 * self.n + 1)
        scaled = z * self.units
        position = self.manifold.going(self.y, scaled[:n])
        phi, phi_y, _ = self.driven(self.time + scaled[2 * n], position, self.p)
        residual = ca.vertcat(
            phi / self.rows,
            ca.mtimes(phi_y, scaled[n : 2 * n]) / self.rows,
            ca.dot(ca.DM(direction), z[n : 2 * n]) - 1,
        )
        return ca.Function("fold", [z], [residual, ca.jacobian(residual, z)])

    def split(self, z: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Time after the last position, position and direction, in SI units."""
        scaled = z * self.units
        position = self.manifold.go(self.y, scaled[: self.n])
        return float(scaled[-1]), position, scaled[self.n : -1]

    def residual(self, x: np.ndarray) -> Residual:
        return Residual(self._system(x)[0].full().ravel(), 1.0)

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        return -np.asarray(np.linalg.solve(self._system(x)[1].full(), residual.value))

    def turns_back(self, z: np.ndarray) -> bool:
        """Whether ``Φ_t`` leaves the range of ``C``, as at a fold but not at a branch point."""
        after, y, _ = self.split(z)
        by_y, by_t = self._tangents(self.time + after, y)
        left = np.linalg.svd(by_y.T)[2][-1]
        return bool(abs(left @ by_t) > TURNS * np.linalg.norm(by_t))
