"""What a formulation is: a way to solve the saddle system of (5.7).

    ⎡M  Cᵀ⎤ ⎡v̇⎤   ⎡f − d⎤
    ⎣C  0 ⎦ ⎣λ ⎦ = ⎣  ξ  ⎦

All formulations are algebraically equal; they differ in how they solve it and in what they can
take. A formulation writes one file with a ``SaddleSolver``; the equation it satisfies, and with
it the exact derivatives of its result, are common to all and stated here.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.model.equations import Equations
from dalembert.symbolic.implicit import ImplicitFunction, Stage


class SaddleSolver:
    """Solves ``M x + Cᵀ z = r1``, ``C x = r2`` with factors that are computed once.

    Made from ``M`` (n, n) and ``C`` (m, n).
    """

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        """``(x, z)``; the matrix is symmetric, so this is its transposed solve too."""
        raise NotImplementedError

    def solve_stacked(self, rhs: ca.SX) -> ca.SX:
        n = self.speed_count
        return ca.vertcat(*self.solve(rhs[:n], rhs[n:]))

    speed_count: int


@dataclass(frozen=True)
class Formulation:
    """Strategy object: how accelerations and multipliers are found."""

    def solver(self, mass: ca.SX, jacobian: ca.SX, massless: tuple[int, ...]) -> SaddleSolver:
        raise NotImplementedError

    def acceleration(
        self,
        e: Equations,
        xi: ca.SX,
        outputs: list[ca.SX] | None = None,
        name: str = "acceleration",
    ) -> ImplicitFunction:
        """``(t, [y; v; w], p) → outputs`` of the accelerations and multipliers.

        Parameters
        ----------
        e : Equations
        xi : SX (m,), right-hand side ``ξ`` of ``C v̇ = ξ``, stabilised or not
        outputs : expressions of t, y, v, v̇, λ, p; by default ``[v̇, λ]``
        """
        c = e.jacobian
        solver = self.solver(e.mass, c, e.massless)
        unknown = ca.vertcat(e.a, e.multiplier)
        residual = ca.vertcat(
            ca.mtimes(e.mass, e.a) + e.bias - e.force + ca.mtimes(c.T, e.multiplier),
            ca.mtimes(c, e.a) - xi,
        )
        value = ca.vertcat(*solver.solve(e.force - e.bias, xi))
        stage = Stage(unknown, residual, value, solver.solve_stacked, solver.solve_stacked)
        inputs = [e.t, state_symbols(e), e.p]
        return ImplicitFunction(name, inputs, [stage], outputs or [e.a, e.multiplier])


def state_symbols(e: Equations) -> ca.SX:
    """State ``x = [y; v; w]``; ``w`` accumulates dissipated energy and energy input."""
    return ca.vertcat(e.y, e.v, WORK)


WORK = ca.SX.sym("work", 2)


def state_rate(e: Equations) -> ca.SX:
    """``ẋ`` in terms of accelerations and multipliers."""
    return ca.vertcat(e.pose_rate, e.a, e.powers)
