"""BDF error estimates, and the choice of order and step length."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.integrators.base import Problem
from dalembert.integrators.bdf.differences import ERROR, by_order
from dalembert.integrators.marching.error_norm import impulsive, largest, relative_error
from dalembert.integrators.marching.step_control import STANDSTILL

SAFETY, MAXIMUM_GROWTH, MINIMUM_GROWTH = 0.81, 10.0, 0.2
"""Safety factor, upper and lower limit of the change of the step length [-]."""


@dataclass(frozen=True)
class Accuracy:
    """Tolerances of the steps and the range of orders."""

    rtol: float
    atol: np.ndarray
    max_order: int = 5
    min_order: int = 1


class BdfControl:
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
