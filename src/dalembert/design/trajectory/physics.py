"""Equations of a mechanism at one instant, for direct collocation.

Constraints of closed loops and Euler parameters hold at the knots at the levels of position, speed
and acceleration. In the middle of an interval the interpolants violate them; displacements ``C``
ᵀγ and separate multipliers compensate for this, so that there are as many unknowns as equations
(Posa, Kuindersma and Tedrake, *Optimization and stabilization of trajectories for
constrained dynamical systems*, 2016).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.model import Model
from dalembert.model.graph.scheduled import check_controls
from dalembert.symbolic.formulas.expression import stack


class Physics:
    """Functions of ``t, y, v, a, λ, u, q`` with controls u and varied parameters q.

    Parameters
    ----------
    model : Model
    controls, vary : names of parameters
    p : values of the other parameters
    """

    def __init__(self, model: Model, controls: Sequence[str], vary: Sequence[str], p: np.ndarray):
        self.model, self.controls, self.vary, self.p = model, list(controls), list(vary), p
        e = self.equations = model.equations
        if e.contacts:
            raise UnsupportedError(
                "trajectories with rigid contacts are not optimised; leave out "
                f"{e.contacts[0].name!r}, or make it a compliant contact"
            )
        if model.parts.space.computed and vary:
            raise UnsupportedError(
                "shapes of flexible bodies cannot vary with a trajectory; leave out vary="
            )
        check_controls(model, self.controls)
        order = list(model.parameters)
        moving = [order.index(name) for name in (*self.controls, *self.vary)]
        fixed = [k for k in range(e.p.numel()) if k not in moving]
        self._fixed = e.p[fixed, :], ca.SX(p[fixed])
        self.u = stack(model.parameters[name].sx for name in self.controls)
        self.q = stack(model.parameters[name].sx for name in self.vary)
        self.state = [e.t, e.y, e.v, e.a, e.multiplier, self.u, self.q]

    def of_state(self, name: str, expression: ca.SX) -> ca.Function:
        """``(t, y, v, a, λ, u, q) →`` an expression."""
        return ca.Function(name, self.state, [self._with_values(expression)], {"cse": True})

    def _with_values(self, expression: ca.SX) -> ca.SX:
        """Insert the values of the fixed parameters."""
        dense = self.model.equations.without_dropped(ca.densify(expression))
        return ca.substitute(dense, *self._fixed)

    @property
    def position_conditions(self) -> ca.SX:
        """Residuals of a position: constraints, and normalisation of the manifold."""
        e = self.equations
        return ca.vertcat(e.constraints[list(e.holds), :], e.manifold.bounds)

    @cached_property
    def balance(self) -> ca.SX:
        """``M v̇ + d − f + Cᵀ λ``."""
        e = self.equations
        inner = e.inertia.times(e.a) + e.bias - e.force
        return inner + ca.mtimes(e.jacobian.T, e.multiplier)

    @cached_property
    def sizes(self) -> dict[str, np.ndarray]:
        """Natural sizes of equations by kind."""
        s, e = self.model.scales, self.equations
        rows = e.scales.rows
        return {
            "position": np.r_[rows[list(e.holds)], np.ones(e.manifold.bounds.numel())],
            "speed": rows / s.time,
            "balance": s.efforts,
            "acceleration": rows / s.time**2,
        }

    def rows(self, *kinds: str) -> ca.Function:
        """``→`` stacked equations of these kinds, divided by their natural sizes.

        ``position`` and ``speed`` are constraints, ``balance`` and ``acceleration`` give ``v̇, λ``.
        """
        e = self.equations
        parts = {
            "position": self.position_conditions,
            "speed": e.velocity_constraints,
            "balance": self.balance,
            "acceleration": ca.mtimes(e.jacobian, e.a) - e.constraint_acceleration,
        }
        scaled = [parts[kind] / self.sizes[kind] for kind in kinds or parts]
        return self.of_state("knot", ca.vertcat(*scaled))

    @cached_property
    def middle(self) -> ca.Function:
        """``(ẏ, γ, t, y, v, a, λ, u, q) → ẏ − A v − slack, balance``, scaled."""
        e, s = self.equations, self.model.scales
        rate = ca.SX.sym("rate", e.coordinate_count)
        slack = ca.SX.sym("slack", self.position_conditions.numel())
        count, lead = len(e.holds), ca.SX.zeros(e.coordinate_count)
        if count:
            push = ca.mtimes(e.position_jacobian[list(e.holds), :].T, slack[:count])
            lead += ca.mtimes(e.lift, push)
        if e.manifold.bounds.numel():
            lead += ca.mtimes(ca.jacobian(e.manifold.bounds, e.y).T, slack[count:])
        rows = ca.vertcat(
            (rate - e.pose_rate - lead) / (s.coordinates / s.time),
            self.balance / self.sizes["balance"],
        )
        return ca.Function(
            "middle", [rate, slack, *self.state], [self._with_values(rows)], {"cse": True}
        )

    def measure(self, measure: object) -> ca.Function:
        """``(t, y, v, a, λ, u, q) →`` a measure."""
        expression = self.model.expression(measure)  # type: ignore[arg-type]
        return self.of_state("measure", expression.sx)

    @cached_property
    def linear_system(self) -> ca.Function:
        """``(t, y, v, u, q) →`` matrix and constant term of the linear equations for ``v̇, λ``."""
        e = self.equations
        unknowns = ca.vertcat(e.a, e.multiplier)
        rows = ca.vertcat(self.balance, ca.mtimes(e.jacobian, e.a) - e.constraint_acceleration)
        matrix = ca.jacobian(rows, unknowns)
        constant = ca.substitute(rows, unknowns, ca.SX.zeros(unknowns.numel()))
        outputs = [self._with_values(part) for part in (matrix, constant)]
        return ca.Function("linear_system", [e.t, e.y, e.v, self.u, self.q], outputs)

    def accelerations(
        self, t: float, y: np.ndarray, v: np.ndarray, u: np.ndarray, q: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """``v̇`` and ``λ`` at a state, by least squares, for an initial guess."""
        matrix, constant = (part.full() for part in self.linear_system(t, y, v, u, q))
        solution = np.linalg.lstsq(matrix, -constant.ravel(), rcond=1e-10)[0]
        return solution[: v.size], solution[v.size :]


def speed_basis(e: Equations, t: float, y: np.ndarray, p: np.ndarray) -> np.ndarray:
    """(n, f) basis of the speeds that satisfy the constraints at a position."""
    from scipy.linalg import null_space

    jacobian = ca.Function("jacobian", [e.t, e.y, e.v, e.p], [e.jacobian])
    rows = jacobian(t, y, np.zeros(e.speed_count), p).full()
    return np.asarray(null_space(rows)) if rows.size else np.eye(e.speed_count)
