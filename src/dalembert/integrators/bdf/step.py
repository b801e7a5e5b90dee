"""BDF step in backward differences of quasi-constant step.

After the state, x holds the differences ``D₁ … D_{K+1}`` with ``D_j = ∇ʲx``, the order k, the
spacing of the differences and the number of equal steps so far. A step of length h rescales the
polynomial of degree k to the spacing h and solves, with ``d = ∇^{k+1}x⁺``,

    d + ψ − (h/α_k) F(t + h, x⁺, z, p) = 0,   0 = G(t + h, x⁺, z, p),   x⁺ = Σ D_j + d,

where ``ψ = Σ γ_j D_j / α_k`` (Shampine and Reichelt 1997). The order of the next step follows from
x and h alone, so that steps of recorded lengths can be repeated and differentiated.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.integrators.base import Problem
from dalembert.integrators.bdf.control import (
    ALPHA,
    GAMMA,
    Accuracy,
    BDFControl,
    by_order,
    reduction,
    rescaling,
)
from dalembert.integrators.bdf.newton import CorrectorEquations
from dalembert.integrators.step import Step
from dalembert.symbolic.equations.graph_function import GraphFunction

EQUAL_LENGTH = 1e-8
"""Relative difference below which step lengths count as equal [-]."""


class BDFStep(Step):
    """BDF step ``(t, h, x, p) → x⁺`` with the differences in x.

    Parameters
    ----------
    problem : Problem
    accuracy : Accuracy
    corrected : whether the step ends with the correction of the problem, if there is one
    reuse : whether differences of the right spacing are used without rescaling, which changes
        derivatives by h but no values
    """

    def __init__(
        self, problem: Problem, accuracy: Accuracy, corrected: bool = True, reuse: bool = True
    ):
        self.problem, self.accuracy, self.reuse = problem, accuracy, reuse
        self.top = accuracy.max_order
        self.state_size = problem.system.x.numel()
        self.parameter_count = problem.system.p.numel()
        self.size = self.state_size * (self.top + 2) + 3
        self.corrects = corrected and problem.correction is not None
        self._finish = problem.correction if self.corrects else problem.upkeep
        self.control = BDFControl(problem, accuracy)
        self.equations = CorrectorEquations(problem, accuracy, self.control.weights)

    @cached_property
    def begin(self) -> GraphFunction:
        """Memory at the start: order 1, differences of spacing 1 s, ``D₁ = ẋ``."""
        system, n = self.problem.system, self.state_size
        t, x, p = ca.SX.sym("t"), ca.SX.sym("x", n), ca.SX.sym("p", self.parameter_count)
        z = system.start.function(t, x, p)
        rate = ca.substitute(
            system.rate,
            ca.vertcat(system.t, system.x, system.z, system.p),
            ca.vertcat(t, x, z, p),
        )
        memory = ca.vertcat(rate, ca.SX.zeros(n * self.top), 1, 1, 0)
        begin = ca.Function("bdf_begin", [t, x, p], [ca.densify(memory)], {"cse": True})
        return GraphFunction(begin)

    @cached_property
    def plain(self) -> BDFStep:
        return BDFStep(self.problem, self.accuracy, corrected=False)

    @property
    def exact_in_h(self) -> BDFStep:
        return BDFStep(self.problem, self.accuracy, self.corrects, reuse=False)

    @cached_property
    def function(self) -> ca.Function:
        t, h, x, p = self._symbols()
        new, _ = self.trial(t, h, x, p)
        return ca.Function("step", [t, h, x, p], [ca.densify(new)])

    @cached_property
    def residual(self) -> ca.Function:
        """``(t, h, x, p)`` → residual of the equations solved, relative to the tolerance."""
        t, h, x, p = self._symbols()
        _, record = self.trial(t, h, x, p)
        return ca.Function("residual", [t, h, x, p], [record[2]])

    def trial(self, t, h, x, p) -> tuple[ca.MX, ca.MX]:
        """State with memory after the step, and ``[error; growth; residual of Newton]``."""
        k, spacing, run = x[-3], x[-2], x[-1]
        predicted, psi, c, *sums = self.prediction(h, x, self.rescaled(h, x))
        unknown, residual = self.equations.solve(t + h, h, c, predicted, psi, p)
        d = self.equations.difference(t + h, c, predicted, psi, unknown, p)
        state, differences, below, above = self.advance(x, predicted, sums[0], d)
        error = self.control.error(t + h, h, k, state, p, d)
        run = ca.if_else(ca.fabs(h - spacing) < EQUAL_LENGTH * h, run + 1, 1)
        free = run > k
        order, growth = self.control.choice(free, t + h, h, k, state, p, error, below, above)
        growth = ca.if_else(error <= 1, growth, reduction(error, k))
        if self._finish is not None:
            shift = self._finish.function(t + h, state, p) - state
            state = state + shift
            if not (self.corrects and self.problem.translates):
                differences = self.shifted(k, shift, differences)
        new = ca.vertcat(state, differences, order, h, ca.if_else(free, 0, run))
        return new, ca.vertcat(error, growth, residual)

    # differences ---------------------------------------------------------------------
    def _of_state(self, x: ca.SX) -> tuple[ca.SX, ca.SX]:
        n = self.state_size
        return x[:n], ca.reshape(x[n:-3], n, self.top + 1)

    def _used(self, k: ca.SX, count: int) -> ca.SX:
        """Row of ones for differences up to the order, else zeros."""
        return ca.horzcat(*(j <= k for j in range(1, count + 1)))

    @cached_property
    def rescaled(self) -> ca.Function:
        """``(h, x) → D₁ … D_k`` of spacing h, zero beyond the order."""
        h, x = ca.SX.sym("h"), ca.SX.sym("x", self.size)
        _, old = self._of_state(x)
        used = old[:, : self.top] * ca.repmat(self._used(x[-3], self.top), self.state_size, 1)
        new = ca.mtimes(used, rescaling(self.top, h / x[-2]))
        rescale = ca.Function("rescale", [h, x], [ca.densify(new)], {"cse": True})
        if not self.reuse:
            return rescale
        keep = ca.Function("keep", [h, x], [ca.densify(used)])
        branch = ca.Function.if_else("rescaled", rescale, keep)
        length, memory = ca.MX.sym("h"), ca.MX.sym("x", self.size)
        differences = branch(length != memory[-2], length, memory)
        return ca.Function("rescaled", [length, memory], [differences])

    @cached_property
    def prediction(self) -> ca.Function:
        """``(h, x, D) → predicted x⁺, ψ, h/α_k, Σ_{j≥i} D_j``."""
        h, x = ca.SX.sym("h"), ca.SX.sym("x", self.size)
        d = ca.SX.sym("D", self.state_size, self.top)
        alpha = by_order(x[-3], ALPHA[: self.top + 1])
        psi = ca.mtimes(d, GAMMA[1 : self.top + 1]) / alpha
        sums = [d[:, -1]]
        for j in reversed(range(self.top - 1)):
            sums.insert(0, sums[0] + d[:, j])
        out = [x[: self.state_size] + sums[0], psi, h / alpha, ca.horzcat(*sums)]
        return ca.Function("prediction", [h, x, d], out, {"cse": True})

    @cached_property
    def advance(self) -> ca.Function:
        """``(x, predicted, sums, d) → x⁺, D⁺, ∇ᵏx⁺, ∇^{k+2}x⁺``."""
        n, top = self.state_size, self.top
        x, predicted, d = (
            ca.SX.sym("x", self.size),
            ca.SX.sym("predicted", n),
            ca.SX.sym("d", n),
        )
        sums, k = ca.SX.sym("sums", n, top), x[-3]
        _, old = self._of_state(x)
        new = ca.horzcat(*(d + sums[:, j] for j in range(top)), d)  # beyond the order: d
        last = sum((old[:, j] * (j == k) for j in range(1, top + 1)), ca.SX.zeros(n))
        below = sum((new[:, j - 1] * (j == k) for j in range(2, top + 1)), ca.SX.zeros(n))
        out = [predicted + d, ca.vec(new), below, d - last]
        return ca.Function("advance", [x, predicted, sums, d], out, {"cse": True})

    @cached_property
    def shifted(self) -> ca.Function:
        """``(k, δ, D) → D`` after a shift of the current value by δ."""
        k, shift = ca.SX.sym("k"), ca.SX.sym("shift", self.state_size)
        d = ca.SX.sym("D", self.state_size * (self.top + 1))
        return ca.Function("shifted", [k, shift, d], [d + ca.repmat(shift, self.top + 1, 1)])
