"""The symbolic record of a constrained system, book equations (4.1) and (4.12)–(4.14).

    ẏ = A(y) v,      M v̇ + d = f − Cᵀ λ,      Φ(y, t) = 0

with everything else derived: ``C = (∂Φ/∂y) A``, ``Ψ = C v + Φ_t`` and ``ξ`` in ``C v̇ = ξ``.
Formulations transform it; integrators never see a mechanism; sensitivities never see a joint.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca


@dataclass(frozen=True, eq=False)
class Equations:
    """Constrained equations of motion.

    Attributes
    ----------
    t, y, v, p : SX symbols: time, coordinates, speeds, parameters
    a, multiplier : SX symbols of ``v̇`` and ``λ``, for measures
    pose_rate : SX, ``A(y) v``
    mass, bias, force : ``M`` (n, n), ``d`` (n,), ``f`` (n,)
    constraints : ``Φ`` (m,)
    powers : (2,) rates of dissipated energy and of energy input
    massless : speeds whose mass is zero at the nominal parameters
    """

    t: ca.SX
    y: ca.SX
    v: ca.SX
    p: ca.SX
    a: ca.SX
    multiplier: ca.SX
    pose_rate: ca.SX
    mass: ca.SX
    bias: ca.SX
    force: ca.SX
    constraints: ca.SX
    powers: ca.SX
    massless: tuple[int, ...] = ()

    def with_rows(self, rows: list[int]) -> Equations:
        """The same system with some of its constraint equations only; other multipliers are 0."""
        gone = sorted(set(range(self.constraints.numel())) - set(rows))
        powers = self.powers
        if gone:
            powers = ca.substitute(powers, self.multiplier[gone], ca.SX.zeros(len(gone)))
        return replace(
            self,
            constraints=self.constraints[rows],
            multiplier=self.multiplier[rows],
            powers=powers,
        )

    @property
    def coordinate_count(self) -> int:
        return self.y.numel()

    @property
    def speed_count(self) -> int:
        return self.v.numel()

    @property
    def constraint_count(self) -> int:
        return self.constraints.numel()

    @cached_property
    def jacobian(self) -> ca.SX:
        """``C = (∂Φ/∂y) A`` (4.13)."""
        a = ca.jacobian(self.pose_rate, self.v)
        return ca.sparsify(ca.mtimes(ca.jacobian(self.constraints, self.y), a))

    def rate(self, expression: ca.SX) -> ca.SX:
        """Total time derivative of a position-level expression."""
        if not expression.numel():
            return expression
        return ca.jtimes(expression, ca.vertcat(self.t, self.y), ca.vertcat(1, self.pose_rate))

    @cached_property
    def velocity_constraints(self) -> ca.SX:
        """``Ψ = C v + Φ_t``."""
        return self.rate(self.constraints)

    @cached_property
    def constraint_acceleration(self) -> ca.SX:
        """``ξ = −(Ċ v + Φ̇_t)``, so that ``C v̇ = ξ`` (4.14)."""
        return -self.rate(self.velocity_constraints)
