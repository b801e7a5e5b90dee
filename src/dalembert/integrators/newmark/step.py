"""Step of the Newmark family for constrained systems on a manifold.

The rule of ``newmark/rule.py`` with ``ẏ ≈ A(ȳ) w`` and the algebraic equations at the end of the
step, ``0 = G(t⁺, x⁺, z⁺)``, where ȳ is the mean of old and new positions.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import ImplicitIntegrator, Problem
from dalembert.integrators.newmark.rule import NewmarkCoefficients, StepRule
from dalembert.integrators.stage_equations import StageEquations
from dalembert.integrators.step import GraphStep
from dalembert.symbolic.equations.graph_function import GraphFunction
from dalembert.symbolic.equations.newton_node import NewtonNode, constant
from dalembert.symbolic.evaluation.kernel import SELDOM, condensed

SUDDEN = 1.0
"""Threshold of the relative change of accelerations in the first step for ignoring rates [-]."""


class NewmarkStep(GraphStep):
    """Step with memory ``[ẑ; s; powers; 0; first; dẑ/dt]``, the last for first guesses.

    The zeros replace variables of other variants of the run, so that all memories have equal
    length. Rates at a start are used in the first step if it resolves them; the fast vibrations
    that an impact leaves in a stiff body are not resolved, and their rates are set to zero.
    """

    def __init__(
        self, coefficients: NewmarkCoefficients, problem: Problem, settings: ImplicitIntegrator
    ):
        self.coefficients, self.problem = coefficients, problem
        self.equations = e = StageEquations(problem.system)
        s = problem.system
        n, controlled = e.size, problem.controlled
        self.positions = list(range(problem.positions))
        self.speeds = list(range(problem.positions, controlled))
        self.rest = list(range(controlled, n))
        self.t, self.h, self.x, self.p = s.t, ca.SX.sym("h"), s.x, s.p
        self.u = ca.SX.sym("u", e.count)
        self.spare = ca.SX.zeros(2 * problem.spare)
        length = 2 * e.algebraic + len(self.speeds) + len(self.rest) + self.spare.numel() + 1
        self.memory = ca.SX.sym("memory", length)
        self.arguments = ca.vertcat(self.t, self.h, self.x, self.memory, self.p)
        new, memory, rows = self._equations()
        scale = e.residual_scale(settings.tolerance)(self.t + self.h, self.h, new, self.u, self.p)
        outputs = [ca.vertcat(new, memory)]
        sizes = e.unknown_sizes
        self.newton = NewtonNode(
            "newmark", self.u, self.arguments, rows, scale, settings.newton, sizes, outputs
        )
        self._guess = constant("guess", [self.arguments], self._extrapolate())
        size = n + self.memory.numel()
        symbols = [ca.MX.sym(*k) for k in (("t", 1), ("h", 1), ("x", size), ("p", s.p.numel()))]
        end, residual = self._solve(*symbols)
        super().__init__(
            ca.Function("bare_step", symbols, [end]),
            n,
            problem.correction,
            self._start(),
            ca.Function("newton_residual", symbols, [residual]),
            problem.upkeep,
        )

    @property
    def work(self) -> float:
        return self.newton.work

    def _memory_parts(self) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Scaled algebraic variables, ``s`` and powers at the end of the last step."""
        m, k, r = self.equations.algebraic, len(self.speeds), len(self.rest)
        parts = ca.vertsplit(self.memory, [0, m, m + k, m + k + r, self.memory.numel()])
        return parts[0], parts[1], parts[2]

    def _equations(self) -> tuple[ca.SX, ca.SX, ca.SX]:
        """New state, new memory and residuals, as expressions of the unknowns."""
        e, c, t, h, x, p = self.equations, self.coefficients, self.t, self.h, self.x, self.p
        z, stored, powers = self._memory_parts()

        def rate(time, state, u) -> ca.SX:
            return e.rate(time, h, state, u, p)

        old = rate(t, x, ca.vertcat(z, ca.SX.zeros(len(e.coupled))))[self.speeds]
        true = rate(t, x, self.u)[self.speeds]
        sizes = self.problem.system.sizes.rates[self.speeds]
        s = self._if_resolved(stored, old, sizes, abs(c.shift))
        rule = StepRule.of(c, h)
        course = rule.corrected(rule.predicted(x[self.speeds], old, s), true)
        new, middle = ca.SX(x), ca.SX(x)
        middle[self.speeds], new[self.speeds] = course.mean, course.end
        if e.coupled:
            new[e.coupled] = x[e.coupled] + h * self.u[e.algebraic :, :]
        middle[self.positions] = (x[self.positions] + new[self.positions]) / 2
        for _ in e.levels:  # positions that depend on other positions converge level by level
            free = [i for i in self.positions if i not in e.coupled]
            new[free] = x[free] + h * rate(t + h / 2, middle, self.u)[free]
            middle[free] = (x[free] + new[free]) / 2
        rows = e.rows(t + h, h, new, self.u, p)[: e.algebraic, :]
        k = self.u[e.algebraic :, :]
        rows = ca.vertcat(rows, k - rate(t + h / 2, middle, self.u)[e.coupled])
        end_powers = rate(t + h, new, self.u)[self.rest]
        new[self.rest] = x[self.rest] + h / 2 * (powers + end_powers)
        end_z = self.u[: e.algebraic, :]
        memory = [end_z, rule.memory(course, true), end_powers, self.spare, 0, (end_z - z) / h]
        return new, ca.vertcat(*memory), rows

    def _if_resolved(
        self, change: ca.SX, value: ca.SX, sizes: np.ndarray, share: float = 1.0
    ) -> ca.SX:
        """A rate of change, set to zero at a start if the step does not resolve it."""
        if not change.numel():
            return change
        first = self.memory[self.memory.numel() - self.equations.algebraic - 1]
        amount = self.h * ca.mmax(ca.fabs(change) / sizes)
        sudden = amount > SUDDEN * share * (1 + ca.mmax(ca.fabs(value) / sizes))
        return ca.if_else(ca.logic_and(first > 0, sudden), 0, 1) * change

    def _extrapolate(self) -> ca.SX:
        """First guess of the unknowns."""
        e, z = self.equations, self._memory_parts()[0]
        drift = self.memory[self.memory.numel() - e.algebraic :, :]
        drift = self._if_resolved(drift, z, e.unknown_sizes[: e.algebraic])
        u = ca.vertcat(z + self.h * drift, ca.SX(len(e.coupled), 1))
        rate = e.rate(self.t, self.h, self.x, u, self.p)
        return ca.vertcat(u[: e.algebraic, :], rate[e.coupled])

    def _start(self) -> GraphFunction:
        """``(t, x, p) → memory`` with ``s = δ v̈``."""
        system = self.problem.system
        z = system.start.function(self.t, self.x, self.p)
        rate = ca.substitute(system.rate, system.z, z)
        dp = ca.SX.zeros(self.p.numel())
        drift = system.start.tangent(self.t, self.x, self.p, 1, rate, dp)
        along = ca.jtimes(
            system.rate[self.speeds, :],
            ca.vertcat(system.t, system.x, system.z),
            ca.vertcat(1, rate, drift),
        )
        jerk = ca.substitute(along, system.z, z)
        shifted = self.coefficients.shift * jerk
        memory = ca.vertcat(z, shifted, rate[self.rest], self.spare, 1, drift)
        return GraphFunction(condensed("begin", [self.t, self.x, self.p], [memory], SELDOM))

    def _solve(self, t: ca.MX, h: ca.MX, x: ca.MX, p: ca.MX) -> tuple[ca.MX, ca.MX]:
        """New state with memory, relative residual."""
        arguments = ca.vertcat(t, h, x, p)
        (new,), residual = self.newton.results(self._guess(arguments), arguments)
        return new, residual


def check(coefficients: NewmarkCoefficients, problem: Problem, name: str) -> None:
    """Raise unless the rates of positions depend on the speeds in the state alone.

    Raises
    ------
    UnsupportedError
        They depend on algebraic variables, or a system of index 3 is integrated without damping.
    """
    s = problem.system
    instant = [i for i, lag in enumerate(s.lag) if lag == 0]
    if ca.depends_on(s.rate[: problem.positions], s.z[instant]):
        raise UnsupportedError(
            f"{name} needs all speeds in the state, but this formulation has only some; use "
            "Trapezoidal() or Radau(), or formulation=RangeSpace()"
        )
    if s.index == 3 and coefficients.undamped and problem.correction is None:
        raise UnsupportedError(
            f"{name} without damping amplifies every perturbation of the accelerations "
            "if only positions are constrained; use GeneralizedAlpha(rho_inf=0.9), "
            "stabilization=Projection() or DAE(index=2)"
        )
