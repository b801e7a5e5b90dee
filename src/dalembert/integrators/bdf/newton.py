"""The equations of one backward differentiation step, made small and solved by Newton.

Where F passes a variable on unchanged (``ẏ = v``, ``v̇ = a``), the difference of that row is known
in terms of the variable and leaves the system, which is then as large as the accelerations and
multipliers. Rows are measured by what the tolerance allows: a residual of 1 is what errors of
``NEWTON`` times the tolerance in the unknowns make.
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
SETTINGS = NewtonSettings(tolerance=NEWTON, max_iterations=6)
"""A step that needs more iterations is better made shorter."""
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
        self.kept, values = self._reduce()
        self.unknown = ca.vertcat(self.d[self.kept], system.z)
        self.size = self.unknown.numel()
        self.values = ca.vertcat(*values)
        rate, algebraic = ca.substitute(
            [system.rate, system.algebraic], [system.x], [self.predicted + self.values]
        )
        self.rate = rate
        rows = self.d + self.psi - self.c * rate
        self.residual = ca.vertcat(rows[self.kept], algebraic)

    def _reduce(self) -> tuple[list[int], list[ca.SX]]:
        """Rows that stay, and ``d`` in terms of what stays."""
        system, n = self.problem.system, self.problem.system.x.numel()
        places = {system.x[i].__hash__(): i for i in range(n)}
        algebraic = {system.z[j].__hash__() for j in range(system.z.numel())}
        seen = ca.jacobian(ca.vertcat(system.rate, system.algebraic), system.x).sparsity()
        unseen = {i for i in range(n) if not seen.get_col().count(i)}
        values: dict[int, ca.SX] = {}

        def value(i: int, above: tuple[int, ...]) -> ca.SX:
            if i in values:
                return values[i]
            passed = system.rate[i].__hash__()
            found = self.d[i]
            if passed in algebraic:
                found = self.c * system.rate[i] - self.psi[i]
            elif passed in places and places[passed] not in (*above, i):
                j = places[passed]
                found = self.c * (self.predicted[j] + value(j, (*above, i))) - self.psi[i]
            values[i] = found
            return found

        every = [value(i, ()) for i in range(n)]
        kept = [i for i in range(n) if every[i].is_symbolic() and i not in unseen]
        return kept, every

    @cached_property
    def difference(self) -> ca.Function:
        """``(given, unknown) → d`` of all rows; what nothing depends on is integrated last."""
        d = ca.SX(self.values)
        for i in range(d.numel()):
            if d[i].is_symbolic() and i not in self.kept:
                d[i] = self.c * self.rate[i] - self.psi[i]
        system = self.problem.system
        inputs = [system.t, self.c, self.predicted, self.psi, self.unknown, system.p]
        return ca.Function("difference", inputs, [ca.densify(d)], {"cse": True})

    # solution ------------------------------------------------------------------------
    @cached_property
    def _given(self) -> ca.SX:
        system = self.problem.system
        return ca.vertcat(system.t, self.h, self.c, self.predicted, self.psi, system.p)

    @cached_property
    def guess(self) -> ca.Function:
        """``given → unknowns`` at the predicted state."""
        system = self.problem.system
        z = system.start.function(system.t, self.predicted, system.p)
        return constant("guess", [self._given], ca.vertcat(ca.SX.zeros(len(self.kept)), z))

    @cached_property
    def node(self) -> NewtonNode:
        sizes = self.problem.system.sizes
        unknown = np.concatenate([sizes.states[self.kept], sizes.algebraic])
        return NewtonNode(
            "corrector", self.unknown, self._given, self.residual, self._scale(), SETTINGS, unknown
        )

    def _scale(self) -> ca.SX:
        """What errors of ``NEWTON`` times the tolerance, or of rounding, make of each row."""
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
        depth = np.array([*[-1] * len(self.kept), *self.problem.system.depth])
        natural = self.problem.system.sizes
        sizes = np.concatenate([natural.states[self.kept], natural.rows])
        for level in np.unique(depth[depth >= 0]):  # equations of motion without mass have no terms
            rows = [int(i) for i in np.flatnonzero(depth == level)]
            alike = sizes[rows]
            scale[rows] += SMALL_ROWS * alike * ca.mmax(scale[rows] / alike)
        return scale

    def solve(self, t, h, c, predicted, psi, p) -> tuple[ca.MX, ca.MX]:
        """Unknowns, NaN where Newton failed, and the residual left relative to the tolerance."""
        given = ca.vertcat(t, h, c, predicted, psi, p)
        return self.node.solve(self.guess(given), given)
