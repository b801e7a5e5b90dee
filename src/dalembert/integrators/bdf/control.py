"""BDF coefficients and backward differences, error estimates, choice of order and step length."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.integrators.base import Problem
from dalembert.integrators.error_control import STANDSTILL, impulsive, largest, relative_error

KAPPA = np.array([0, -0.1850, -1 / 9, -0.0823, -0.0415, 0, 0])
"""κ_k by order: numerical differentiation formulas (Klopfenstein 1971)."""
GAMMA = np.append(0, np.cumsum(1 / np.arange(1, 7)))
ALPHA = (1 - KAPPA) * GAMMA
ERROR = KAPPA * GAMMA + 1 / np.arange(1, 8)
"""By order k: the error of a step is ``ERROR[k] ∇^{k+1}x`` to first order."""


def by_order(k: ca.SX, values: Sequence[float]) -> ca.SX:
    """``values[k]`` for a symbolic order k."""
    return sum(((k == j) * float(v) for j, v in enumerate(values) if j), ca.SX(0))


def rescaling(order: int, factor: ca.SX) -> ca.SX:
    """(order, order) matrix that rescales rows ``[D₁ … D_k]`` to spacing ``factor``.

    It is ``R(θ) R(1)`` with ``R_ij = Π_{m≤i} (m − 1 − θ j)/m`` (Shampine and Reichelt 1997).
    """

    def ladder(ratio) -> list[list]:
        rows: list[list] = [[1] * (order + 1)]
        for i in range(1, order + 1):
            rows.append([rows[-1][j] * (i - 1 - ratio * j) / i for j in range(order + 1)])
        return rows

    left, right = ladder(factor), ladder(1)
    out = ca.SX.zeros(order, order)
    for i in range(1, order + 1):
        for j in range(1, i + 1):  # differences vanish on polynomials of lower degree
            out[i - 1, j - 1] = sum(left[i][m] * right[m][j] for m in range(1, j + 1))
    return out


SAFETY, MAXIMUM_GROWTH, MINIMUM_GROWTH = 0.81, 10.0, 0.2
"""Safety factor, upper and lower limit of the change of the step length [-]."""


@dataclass(frozen=True)
class Accuracy:
    """Tolerances of the steps and the range of orders."""

    rtol: float
    atol: np.ndarray
    max_order: int = 5
    min_order: int = 1


class BDFControl:
    """Error control of coordinates and speeds.

    Algebraic variables are functions of the states and are not controlled. With index 3, speeds
    normal to the constraints are one order of h less accurate than positions. If a correction
    removes this component, errors are measured along the constraints (``problem.tangential``);
    otherwise the tolerance of speeds is ``1/h`` times that of positions.
    """

    def __init__(self, problem: Problem, accuracy: Accuracy):
        self.problem, self.accuracy = problem, accuracy

    def weights(self, h, x) -> ca.SX:
        """Allowed errors of x."""
        allowed = ca.DM(self.accuracy.atol) + self.accuracy.rtol * ca.fabs(x)
        index_3 = self.problem.system.index == 3 and 2 in self.problem.system.depth
        if not index_3 or self.problem.tangential is not None:
            return allowed
        return impulsive(self.problem, h, allowed)

    def _norm(self, t, h, state, difference, p) -> ca.SX:
        """Maximum norm of a difference relative to the tolerance."""
        allowed = self.weights(h, state)
        return largest(relative_error(self.problem, t, state, p, difference, allowed))

    def _symbols(self) -> tuple[ca.SX, ...]:
        n, m = self.problem.system.x.numel(), self.problem.system.p.numel()
        scalars = (ca.SX.sym(name) for name in ("t", "h", "k"))
        return *scalars, ca.SX.sym("x", n), ca.SX.sym("p", m)

    @cached_property
    def error(self) -> ca.Function:
        """``(t, h, k, x⁺, p, ∇^{k+1}x⁺) → error relative to the tolerance``."""
        t, h, k, state, p = self._symbols()
        d = ca.SX.sym("d", state.numel())
        value = by_order(k, ERROR[: self.accuracy.max_order + 1]) * self._norm(t, h, state, d, p)
        return ca.Function("error", [t, h, k, state, p, d], [value], {"cse": True})

    @cached_property
    def choice(self) -> ca.Function:
        """``(t, h, k, x⁺, p, error, ∇ᵏx⁺, ∇^{k+2}x⁺) → order, growth`` of the next step.

        The order allows the longest step.
        """
        t, h, k, state, p = self._symbols()
        below, above = ca.SX.sym("below", state.numel()), ca.SX.sym("above", state.numel())
        error, top = ca.SX.sym("error"), self.accuracy.max_order
        same = longest(error, k)
        low = by_order(k, [ERROR[max(j - 1, 0)] for j in range(top + 1)])
        high = by_order(k, ERROR[1 : top + 2])
        fewer = longest(low * self._norm(t, h, state, below, p), k - 1)
        fewer = ca.if_else(k > self.accuracy.min_order, fewer, 0)
        more = longest(high * self._norm(t, h, state, above, p), k + 1)
        more = ca.if_else(k < top, more, 0)
        best = ca.fmax(same, ca.fmax(fewer, more))
        order = ca.if_else(best == same, k, ca.if_else(best == more, k + 1, k - 1))
        inputs = [t, h, k, state, p, error, below, above]
        out = [order, ca.fmin(MAXIMUM_GROWTH, best)]
        decide = ca.Function("choice", inputs, out, {"cse": True})
        keep = ca.Function("keep", inputs, [k, ca.SX(1)])
        return ca.Function.if_else("choice_if_free", decide, keep)


def longest(error, order):
    """Factor of the step length at which the error would meet the tolerance."""
    return SAFETY * ca.fmax(error, STANDSTILL) ** (-1 / (order + 1))


def reduction(error, order):
    """Factor of the step length after a rejected step."""
    return ca.fmin(0.9, ca.fmax(MINIMUM_GROWTH, longest(error, order)))
