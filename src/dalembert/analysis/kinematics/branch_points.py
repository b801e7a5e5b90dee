"""Branch points of a driven mechanism: positions in which its branches meet.

The motion goes smoothly through them, and the determinant of the Jacobian ``C`` changes its sign.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dalembert.analysis.kinematics.kernel import KinematicsKernel

MANY = 400
"""Displacements of a mechanism from which on the determinants are not worth their time."""


class BranchPoints:
    """Those between the positions of a motion.

    Parameters
    ----------
    kernel : KinematicsKernel
    p : (np,) parameters
    times : (k,) of the positions
    table : (n, k) configurations, as the kernel gives them
    """

    def __init__(
        self, kernel: KinematicsKernel, p: np.ndarray, times: np.ndarray, table: np.ndarray
    ):
        self.kernel, self.p, self.times, self.table = kernel, p, times, table
        self.n = kernel.e.coordinate_count

    def __iter__(self) -> Iterator[tuple[float, np.ndarray]]:
        """Time and position of each."""
        if self.times.size < 2 or self.kernel.e.scales.displacements.size > MANY:
            return
        signs = self._signs()
        for k in np.flatnonzero(signs[:-1] * signs[1:] < 0):
            time = self._located(int(k))
            yield time, self._position(int(k), time)

    def _signs(self) -> np.ndarray:
        """(k,) of the determinants."""
        mapped, n = self.kernel.jacobian.map(self.times.size), self.kernel.e.speed_count
        p = np.tile(self.p[:, None], self.times.size)
        flat = np.asarray(mapped(self.times, self.table[: self.n], p)[1].full())
        return np.linalg.slogdet(flat.reshape(n, self.times.size, n).transpose(1, 0, 2))[0]

    def _position(self, k: int, time: float) -> np.ndarray:
        """The position at a time between two of the table."""
        step = time - self.times[k]
        new = self.kernel.single(self.table[:, k], time, step, self.p).full().ravel()
        return new[: self.n]

    def _located(self, k: int) -> float:
        """The time at which the sign changes, by bisection."""
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
