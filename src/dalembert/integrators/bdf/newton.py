"""Reduced corrector equations of a BDF step and their solution by Newton's method.

If F returns a variable unchanged (``ẏ = v``, ``v̇ = a``), the difference of that row is an explicit
function of the variable and is eliminated. The reduced system has the size of the accelerations and
multipliers. Rows are scaled by the tolerance: a residual of 1 corresponds to errors of ``NEWTON``
times the tolerance in the unknowns.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.integrators.base import Problem
from dalembert.integrators.bdf.control import Accuracy
from dalembert.integrators.stage_equations import SMALL_ROWS
from dalembert.symbolic.equations.newton import NewtonSettings
from dalembert.symbolic.equations.newton_node import NewtonNode, constant

NEWTON = 1e-5
"""Tolerance of Newton's method relative to the tolerance of the step [-]."""
SETTINGS = NewtonSettings(tolerance=NEWTON, max_iterations=6)
"""Few iterations: a step that needs more is repeated with a shorter length."""
ROUNDING = 20 * 2.2e-16
TINY = 1e-200


class CorrectorEquations:
    """``d + ψ − c F(t, x̂ + d, z, p) = 0``, ``G(t, x̂ + d, z, p) = 0`` for ``d`` and ``z``."""

    def __init__(self, problem: Problem, accuracy: Accuracy, weights: Callable):
        self.problem, self.accuracy, self.weights = problem, accuracy, weights
        system = problem.system
        n = system.x.numel()
        self.h, self.c = ca.SX.sym("h"), ca.SX.sym("c")
        self.predicted, self.psi = ca.SX.sym("predicted", n), ca.SX.sym("psi", n)
        self.d = ca.SX.sym("d", n)
        self.retained, values = self._reduce()
        self.unknown = ca.vertcat(self.d[self.retained], system.z)
        self.size = self.unknown.numel()
        self.values = ca.vertcat(*values)
        rate, algebraic = ca.substitute(
            [system.rate, system.algebraic], [system.x], [self.predicted + self.values]
        )
        self.rate = rate
        rows = self.d + self.psi - self.c * rate
        self.residual = ca.vertcat(rows[self.retained], algebraic)

    def _reduce(self) -> tuple[list[int], list[ca.SX]]:
        """Retained rows, and ``d`` as expressions of the retained entries."""
        system, n = self.problem.system, self.problem.system.x.numel()
        index = {system.x[i].__hash__(): i for i in range(n)}
        algebraic = {system.z[j].__hash__() for j in range(system.z.numel())}
        sparsity = ca.jacobian(ca.vertcat(system.rate, system.algebraic), system.x).sparsity()
        unused = {i for i in range(n) if not sparsity.get_col().count(i)}
        values: dict[int, ca.SX] = {}

        def value(i: int, above: tuple[int, ...]) -> ca.SX:
            if i in values:
                return values[i]
            rate = system.rate[i].__hash__()
            difference = self.d[i]
            if rate in algebraic:
                difference = self.c * system.rate[i] - self.psi[i]
            elif rate in index and index[rate] not in (*above, i):
                j = index[rate]
                difference = self.c * (self.predicted[j] + value(j, (*above, i))) - self.psi[i]
            values[i] = difference
            return difference

        differences = [value(i, ()) for i in range(n)]
        retained = [i for i in range(n) if differences[i].is_symbolic() and i not in unused]
        return retained, differences

    @cached_property
    def difference(self) -> ca.Function:
        """``(…, unknown, p) → d`` of all rows; rows that no equation depends on are explicit."""
        d = ca.SX(self.values)
        for i in range(d.numel()):
            if d[i].is_symbolic() and i not in self.retained:
                d[i] = self.c * self.rate[i] - self.psi[i]
        system = self.problem.system
        inputs = [system.t, self.c, self.predicted, self.psi, self.unknown, system.p]
        return ca.Function("difference", inputs, [ca.densify(d)], {"cse": True})

    # solution ------------------------------------------------------------------------
    @cached_property
    def _arguments(self) -> ca.SX:
        system = self.problem.system
        return ca.vertcat(system.t, self.h, self.c, self.predicted, self.psi, system.p)

    @cached_property
    def guess(self) -> ca.Function:
        """``arguments → unknowns`` at the predicted state."""
        system = self.problem.system
        z = system.start.function(system.t, self.predicted, system.p)
        return constant("guess", [self._arguments], ca.vertcat(ca.SX.zeros(len(self.retained)), z))

    @cached_property
    def node(self) -> NewtonNode:
        sizes = self.problem.system.sizes
        unknown = np.concatenate([sizes.states[self.retained], sizes.algebraic])
        return NewtonNode(
            "corrector",
            self.unknown,
            self._arguments,
            self.residual,
            self._scale(),
            SETTINGS,
            unknown,
        )

    def _scale(self) -> ca.SX:
        """Change of each row by errors of ``NEWTON`` times the tolerance and by rounding."""
        weights = self.weights(self.h, self.predicted)
        reach = ca.jacobian(self.values, self.unknown)
        allowed = ca.SX.zeros(self.size)
        for j in range(self.size):
            bounds = [weights[i] / ca.fabs(reach[i, j]) for i in reach[:, j].sparsity().row()]
            allowed[j] = functools.reduce(ca.fmin, bounds) if bounds else 0
        slopes = ca.fabs(ca.jacobian(self.residual, self.unknown))
        size = ca.fabs(self.predicted) + ca.DM(self.accuracy.atol) / self.accuracy.rtol
        rounded = ca.mtimes(ca.fabs(ca.jacobian(self.residual, self.predicted)), size)
        rounded += ca.mtimes(slopes, ca.fabs(self.unknown))
        scale = NEWTON * ca.mtimes(slopes, allowed) + ROUNDING * rounded + TINY
        depth = np.array([*[-1] * len(self.retained), *self.problem.system.depth])
        natural = self.problem.system.sizes
        sizes = np.concatenate([natural.states[self.retained], natural.rows])
        for level in np.unique(depth[depth >= 0]):  # massless equations of motion have no terms
            rows = [int(i) for i in np.flatnonzero(depth == level)]
            row_sizes = sizes[rows]
            scale[rows] += SMALL_ROWS * row_sizes * ca.mmax(scale[rows] / row_sizes)
        return scale

    def solve(self, t, h, c, predicted, psi, p) -> tuple[ca.MX, ca.MX]:
        """Unknowns, NaN if Newton's method failed, and the residual relative to the tolerance."""
        arguments = ca.vertcat(t, h, c, predicted, psi, p)
        return self.node.solve(self.guess(arguments), arguments)
