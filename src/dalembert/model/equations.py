"""The symbolic record of a constrained system, book equations (4.1) and (4.12)–(4.14).

    ẏ = A(y) v,      M v̇ + d = f − Cᵀ λ,      Φ(y, t) = 0

with everything else derived: ``C = (∂Φ/∂y) A``, ``Ψ = C v + Φ_t`` and ``ξ`` in ``C v̇ = ξ``.
Nonholonomic equations have a ``Ψ`` only. They stand behind those of positions, with nothing but
zero in their rows of ``Φ``.
Formulations transform it; integrators never see a mechanism; sensitivities never see a joint.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import casadi as ca
import numpy as np
import scipy

from dalembert.model.inertia import Inertia
from dalembert.model.manifold import Manifold
from dalembert.model.rigid_gaps import RigidGap, contact_forces
from dalembert.model.scales import Scales
from dalembert.symbolic.formulas.switches import Switches, hold


@dataclass(frozen=True, eq=False)
class ConstraintKinematics:
    """Derivatives of the constraints, where they are known by a shorter way than from ``Φ(y)``.

    Attributes
    ----------
    jacobian : ``(∂Φ/∂y) A`` (m, n)
    velocity : ``Ψ`` (m,), of nonholonomic equations, too
    acceleration : ``ξ`` (m,)
    """

    jacobian: ca.SX
    velocity: ca.SX
    acceleration: ca.SX

    def with_rows(self, rows: list[int]) -> ConstraintKinematics:
        """Of some of the equations."""
        parts = self.jacobian, self.velocity, self.acceleration
        return ConstraintKinematics(*(part[rows, :] for part in parts))


@dataclass(frozen=True, eq=False)
class Equations:
    """Constrained equations of motion.

    Attributes
    ----------
    t, y, v, p : SX symbols: time, coordinates, speeds, parameters
    a, multiplier : SX symbols of ``v̇`` and ``λ``, for measures
    pose_rate : SX, ``A(y) v``
    inertia : ``M`` (n, n)
    bias, force : ``d`` (n,), ``f`` (n,)
    constraints : ``Φ`` (m,), zero in the rows of nonholonomic equations
    nonholonomic : (m,) ``Ψ`` of nonholonomic equations, zero in the other rows
    potential : energy stored in conservative forces
    powers : (2,) rates of dissipated energy and of energy input
    massless : speeds whose mass is zero at the nominal parameters
    dropped : SX symbols of multipliers of equations left out as redundant
    scales : natural sizes of coordinates, rows and the rest; units where nothing is known
    manifold : of the positions; that of coordinates whose rates are the speeds where not given
    known : derivatives of the constraints that need not be made of them
    contacts : rigid gaps, of which ``touching`` makes constraints
    follows : SX symbols of forces that follow from multipliers, and what they are
    rubbing : (n,) generalised forces of these
    switches : of forces and constraints, held on sides that belong to the state; none where
        formulas follow the branches they choose
    """

    t: ca.SX
    y: ca.SX
    v: ca.SX
    p: ca.SX
    a: ca.SX
    multiplier: ca.SX
    pose_rate: ca.SX
    inertia: Inertia
    bias: ca.SX
    force: ca.SX
    constraints: ca.SX
    potential: ca.SX
    powers: ca.SX
    massless: tuple[int, ...] = ()
    dropped: ca.SX = field(default_factory=lambda: ca.SX(0, 1))
    scales: Scales = field(default=None)  # type: ignore[assignment]
    switches: Switches = field(default_factory=Switches)
    manifold: Manifold = field(default=None)  # type: ignore[assignment]
    nonholonomic: ca.SX = field(default=None)  # type: ignore[assignment]
    known: ConstraintKinematics | None = None
    contacts: tuple[RigidGap, ...] = ()
    follows: tuple[ca.SX, ca.SX] = field(default_factory=lambda: (ca.SX(0, 1), ca.SX(0, 1)))
    rubbing: ca.SX = field(default=None)  # type: ignore[assignment]

    def __post_init__(self) -> None:
        if self.scales is None:
            known = Scales.units(self.coordinate_count, self.speed_count, self.constraint_count)
            object.__setattr__(self, "scales", known)
        if self.nonholonomic is None:
            object.__setattr__(self, "nonholonomic", ca.SX(self.constraint_count, 1))
        if self.rubbing is None:
            object.__setattr__(self, "rubbing", ca.SX(self.speed_count, 1))
        if self.manifold is None:
            object.__setattr__(self, "manifold", Manifold.plain(self.y))

    def held(self) -> Equations:
        """The same system with every switch held on its side."""
        moving = ca.vertcat(self.t, self.y, self.v)
        parts = [self.bias, self.force, self.constraints, self.potential, self.powers]
        (bias, force, constraints, potential, powers), switches = hold(parts, moving)
        known = None
        if not hold([self.constraints], moving)[1].count:  # roots in them know of no side
            constraints, known = self.constraints, self.known
        return replace(
            self,
            known=known,
            bias=bias,
            force=force,
            constraints=constraints,
            potential=potential,
            powers=powers,
            switches=switches,
        )

    def with_rows(self, rows: list[int]) -> Equations:
        """The same system with some of its constraint equations only; other multipliers are 0."""
        gone = sorted(set(range(self.constraint_count)) - set(rows))
        kept = replace(
            self,
            constraints=self.constraints[rows, :],
            known=None if self.known is None else self.known.with_rows(rows),
            nonholonomic=self.nonholonomic[rows, :],
            multiplier=self.multiplier[rows, :],
            dropped=ca.vertcat(self.dropped, self.multiplier[gone, :]),
            scales=self.scales.with_rows(rows),
        )
        return replace(kept, powers=kept.without_dropped(self.powers))

    def without_dropped(self, expression: ca.SX) -> ca.SX:
        """The expression with forces that follow, and multipliers of equations left out at zero."""
        expression = ca.substitute(expression, *self.follows)
        return ca.substitute(expression, self.dropped, ca.SX.zeros(self.dropped.numel()))

    @property
    def transmitted(self) -> ca.SX:
        """Multipliers, and behind them the forces of rigid contacts."""
        return ca.vertcat(self.multiplier, contact_forces(self.contacts))

    @property
    def contact_push(self) -> ca.SX:
        """(n,) generalised forces ``Wᵀ N + Uᵀ T`` of rigid contacts."""
        push = ca.SX(self.speed_count, 1)
        for gap in self.contacts:
            push += ca.mtimes(self.by_displacement(gap.distance).T, gap.normal)
            push += ca.mtimes(ca.jacobian(gap.slip, self.v).T, gap.tangential)
        return push

    @property
    def mass(self) -> ca.SX:
        """``M`` as a matrix."""
        return self.inertia.matrix

    def mass_at(self, y: np.ndarray, p: np.ndarray) -> scipy.sparse.csc_array:
        """``M`` at a position for parameter values ``p``."""
        function = ca.Function("mass", [self.y, self.p], [self.mass])
        return scipy.sparse.csc_array(function(y, p).sparse())

    @property
    def metric(self) -> ca.SX:
        """``M`` with a natural mass for speeds that have none, so that it can be inverted."""
        units = ca.SX(self.speed_count, 1)
        for k in self.massless:
            units[k] = self.scales.mass * (self.scales.length / self.scales.displacements[k]) ** 2
        return self.mass + ca.diag(units)

    @cached_property
    def kinetic_energy(self) -> ca.SX:
        """``T = vᵀ M v / 2``."""
        return ca.dot(self.v, self.inertia.times(self.v)) / 2

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
    def lift(self) -> ca.SX:
        """``A(y)`` (4.1); nothing displaces a coordinate whose rate is no speed."""
        found = ca.jacobian(self.pose_rate, self.v)
        if not ca.depends_on(found, self.v):
            return found
        bent = [ca.depends_on(found[k, :], self.v) for k in range(found.shape[0])]
        return ca.sparsify(ca.mtimes(ca.diag(ca.SX([0 if b else 1 for b in bent])), found))

    @cached_property
    def jacobian(self) -> ca.SX:
        """``C = (∂Φ/∂y) A`` (4.13), with ``∂Ψ/∂v`` of nonholonomic equations."""
        return ca.sparsify(self.position_jacobian + self.slip_jacobian)

    @cached_property
    def position_jacobian(self) -> ca.SX:
        """``(∂Φ/∂y) A``, without entries in the rows of nonholonomic equations."""
        if self.known is not None:
            return self.known.jacobian
        return self.by_displacement(self.constraints)

    @cached_property
    def slip_jacobian(self) -> ca.SX:
        """``∂Ψ/∂v`` of nonholonomic equations, without entries in the other rows."""
        return ca.sparsify(ca.jacobian(self.nonholonomic, self.v))

    @cached_property
    def slips(self) -> tuple[int, ...]:
        """Rows of nonholonomic equations."""
        rows = ca.sparsify(self.nonholonomic).sparsity().row()
        return tuple(int(k) for k in rows)

    @cached_property
    def holds(self) -> tuple[int, ...]:
        """Rows of equations of positions."""
        return tuple(k for k in range(self.constraint_count) if k not in self.slips)

    def by_displacement(self, expression: ca.SX) -> ca.SX:
        """Derivative ``(∂·/∂y) A`` of an expression of positions by displacements."""
        return ca.sparsify(ca.mtimes(ca.jacobian(expression, self.y), self.lift))

    def rate(self, expression: ca.SX) -> ca.SX:
        """Total time derivative of a position-level expression."""
        if not expression.numel():
            return expression
        return ca.jtimes(expression, ca.vertcat(self.t, self.y), ca.vertcat(1, self.pose_rate))

    @cached_property
    def velocity_constraints(self) -> ca.SX:
        """``Ψ = C v + Φ_t``."""
        if self.known is not None:
            return self.known.velocity
        return self.rate(self.constraints) + ca.densify(self.nonholonomic)

    @cached_property
    def constraint_acceleration(self) -> ca.SX:
        """``ξ = −(Ċ v + Φ̇_t)``, so that ``C v̇ = ξ`` (4.14)."""
        if self.known is not None:
            return self.known.acceleration
        return -self.rate(self.velocity_constraints)
