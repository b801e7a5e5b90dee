"""Cubic splines written out in the expression graph: C², periodic or natural."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from dalembert.errors import ModelError
from dalembert.symbolic.expression import as_sx


class CubicSpline:
    """Interpolating cubic spline with fixed knots; the values may be formulas.

    Second derivatives ``m`` at the knots depend linearly on the values, ``m = T v`` with a
    constant matrix, so the spline is differentiable with respect to its values too.

    Parameters
    ----------
    knots : (n,) increasing floats
    values : n numbers or formulas
    periodic : the last value equals the first and the spline repeats
    entity : name used in messages
    """

    def __init__(self, knots: ArrayLike, values: list, periodic: bool, entity: str):
        self.knots = np.asarray(knots, dtype=float)
        n = self.knots.size
        if n < 3:
            raise ModelError(f"a spline needs at least 3 rows, got {n}", entity)
        if not np.all(np.isfinite(self.knots)):
            raise ModelError("the abscissae contain NaN or infinity", entity)
        steps = np.diff(self.knots)
        if np.any(steps <= 0):
            k = int(np.argmax(steps <= 0))
            raise ModelError(
                f"abscissae must increase, but row {k + 2} ({self.knots[k + 1]}) "
                f"does not follow row {k + 1} ({self.knots[k]})",
                entity,
            )
        self.values = ca.vertcat(*(as_sx(v) for v in values))
        for k in range(n):
            if self.values[k].is_constant() and not np.isfinite(float(self.values[k])):
                raise ModelError(f"value in row {k + 1} is not finite", entity)
        self.periodic = periodic
        if periodic:
            self._check_closed(entity)
        self.curvatures = ca.mtimes(ca.DM(_curvature_matrix(steps, periodic)), self.values)

    def _check_closed(self, entity: str) -> None:
        gap = self.values[-1] - self.values[0]
        scale = 1.0
        if self.values.is_constant():
            scale = max(1.0, float(ca.mmax(ca.fabs(self.values))))
        if gap.is_constant() and abs(float(gap)) > 1e-9 * scale:
            raise ModelError(
                f"a periodic spline must end where it begins; it misses by {float(gap)}",
                entity,
            )

    def __call__(self, x: ca.SX) -> ca.SX:
        first, last = self.knots[0], self.knots[-1]
        if self.periodic:
            x = x - (last - first) * ca.floor((x - first) / (last - first))
        inner = list(self.knots[1:-1])

        def pick(column):  # piecewise constant: the column's entry of the interval of x
            if column.is_constant() and float(ca.mmax(ca.fabs(column - column[0]))) == 0.0:
                return column[0]
            jumps = (
                (column[k + 1] - column[k]) * _reached(x, knot) for k, knot in enumerate(inner)
            )
            return sum(jumps, column[0])

        left, right = pick(ca.SX(ca.DM(self.knots[:-1]))), pick(ca.SX(ca.DM(self.knots[1:])))
        h = right - left
        v0, v1 = pick(self.values[:-1]), pick(self.values[1:])
        m0, m1 = pick(self.curvatures[:-1]), pick(self.curvatures[1:])
        a, b = right - x, x - left
        slope0 = (v1 - v0) / h - h * (2 * m0 + m1) / 6
        slope1 = (v1 - v0) / h + h * (m0 + 2 * m1) / 6
        inside = (
            (m0 * a**3 + m1 * b**3) / (6 * h)
            + (v0 / h - m0 * h / 6) * a
            + (v1 / h - m1 * h / 6) * b
        )
        if self.periodic:
            return inside
        before = v0 + slope0 * (x - left)
        after = v1 + slope1 * (x - right)
        within = ca.if_else(_reached(x, last), after, inside)
        return ca.if_else(_reached(x, first), within, before)


def _reached(x: ca.SX, knot: float) -> ca.SX:
    """1 from the knot on, else 0; no comparison, for at knots the spline is smooth."""
    return (1 + ca.copysign(1, x - knot)) / 2


def _curvature_matrix(h: np.ndarray, periodic: bool) -> np.ndarray:
    """``T`` with ``m = T v``: continuity of the slope, natural or periodic ends."""
    n = h.size + 1
    a, b = np.zeros((n, n)), np.zeros((n, n))
    for k in range(1, n - 1):
        a[k, k - 1 : k + 2] = h[k - 1] / 6, (h[k - 1] + h[k]) / 3, h[k] / 6
        b[k, k - 1 : k + 2] = 1 / h[k - 1], -1 / h[k - 1] - 1 / h[k], 1 / h[k]
    if periodic:
        a[0, [0, 1, n - 2]] += (h[-1] + h[0]) / 3, h[0] / 6, h[-1] / 6
        b[0, 1] += 1 / h[0]
        b[0, 0] -= 1 / h[0] + 1 / h[-1]
        b[0, n - 2] += 1 / h[-1]
        a[n - 1, [0, n - 1]] = -1, 1
    else:
        a[0, 0] = a[n - 1, n - 1] = 1
    return np.linalg.solve(a, b)
