"""Symbolic equations of motion of a constrained system, book equations (4.1) and (4.12)–(4.14).

    ẏ = A(y) v,      M v̇ + d = f − Cᵀ λ,      Φ(y, t) = 0

with everything else derived: ``C = (∂Φ/∂y) A``, ``Ψ = C v + Φ_t`` and ``ξ`` in ``C v̇ = ξ``.
Nonholonomic equations have a ``Ψ`` only. They follow the holonomic ones, with zeros in their rows
of ``Φ``. Formulations transform the equations; integrators and sensitivities do not depend on the
mechanism behind them.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import casadi as ca
import numpy as np
import scipy

from dalembert.model.graph.inertia import Inertia
from dalembert.model.graph.manifold import Manifold
from dalembert.model.graph.rigid_gaps import RigidGap, contact_forces
from dalembert.model.graph.scales import Scales
from dalembert.symbolic.formulas.switches import Switches, freeze_branches


@dataclass(frozen=True, eq=False)
class ConstraintKinematics:
    """Derivatives of the constraints, computed more directly than from ``Φ(y)``.

    Attributes
    ----------
    jacobian : ``(∂Φ/∂y) A`` (m, n)
    velocity : ``Ψ`` (m,), including nonholonomic equations
    acceleration : ``ξ`` (m,)
    """

    jacobian: ca.SX
    velocity: ca.SX
    acceleration: ca.SX

    def with_rows(self, rows: list[int]) -> ConstraintKinematics:
        """The derivatives of some of the equations."""
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
    scales : natural sizes of coordinates, rows and the rest; one by default
    manifold : of the positions; by default that of coordinates whose rates are the speeds
    kinematics : derivatives of the constraints, if they are not derived from ``constraints``
    contacts : rigid gaps, which ``touching`` turns into constraints
    follows : SX symbols of forces that follow from multipliers, and their expressions
    rubbing : (n,) generalised forces of these
    switches : of forces and constraints with frozen branches; empty if branches are free
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
    kinematics: ConstraintKinematics | None = None
    contacts: tuple[RigidGap, ...] = ()
    follows: tuple[ca.SX, ca.SX] = field(default_factory=lambda: (ca.SX(0, 1), ca.SX(0, 1)))
    rubbing: ca.SX = field(default=None)  # type: ignore[assignment]

    def __post_init__(self) -> None:
        if self.scales is None:
            units = Scales.units(self.coordinate_count, self.speed_count, self.constraint_count)
            object.__setattr__(self, "scales", units)
        if self.nonholonomic is None:
            object.__setattr__(self, "nonholonomic", ca.SX(self.constraint_count, 1))
        if self.rubbing is None:
            object.__setattr__(self, "rubbing", ca.SX(self.speed_count, 1))
        if self.manifold is None:
            object.__setattr__(self, "manifold", Manifold.plain(self.y))

    def with_frozen_branches(self) -> Equations:
        """The system with frozen branches of all formulas."""
        moving = ca.vertcat(self.t, self.y, self.v)
        parts = [self.bias, self.force, self.constraints, self.potential, self.powers]
        (bias, force, constraints, potential, powers, rate), switches = freeze_branches(
            [*parts, self.pose_rate], moving
        )
        kinematics = None
        if not freeze_branches([self.constraints], moving)[
            1
        ].count:  # roots in them must not be continued
            constraints, kinematics = self.constraints, self.kinematics
        return replace(
            self,
            kinematics=kinematics,
            bias=bias,
            force=force,
            constraints=constraints,
            potential=potential,
            powers=powers,
            pose_rate=rate,
            switches=switches,
        )

    def with_rows(self, rows: list[int]) -> Equations:
        """The system with some of its constraint equations; other multipliers are zero."""
        left_out = sorted(set(range(self.constraint_count)) - set(rows))
        system = replace(
            self,
            constraints=self.constraints[rows, :],
            kinematics=None if self.kinematics is None else self.kinematics.with_rows(rows),
            nonholonomic=self.nonholonomic[rows, :],
            multiplier=self.multiplier[rows, :],
            dropped=ca.vertcat(self.dropped, self.multiplier[left_out, :]),
            scales=self.scales.with_rows(rows),
        )
        return replace(system, powers=system.without_dropped(self.powers))

    def without_dropped(self, expression: ca.SX) -> ca.SX:
        """The expression with dependent forces substituted and dropped multipliers set to zero."""
        expression = ca.substitute(expression, *self.follows)
        return ca.substitute(expression, self.dropped, ca.SX.zeros(self.dropped.numel()))

    @property
    def transmitted(self) -> ca.SX:
        """Multipliers, followed by the forces of rigid contacts."""
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
        """``M`` with a natural mass for massless speeds, so that it is regular."""
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
        """``A(y)`` (4.1), with zero rows for coordinates whose rates are nonlinear in speeds."""
        matrix = ca.jacobian(self.pose_rate, self.v)
        if not ca.depends_on(matrix, self.v):
            return matrix
        nonlinear = [ca.depends_on(matrix[k, :], self.v) for k in range(matrix.shape[0])]
        return ca.sparsify(ca.mtimes(ca.diag(ca.SX([0 if n else 1 for n in nonlinear])), matrix))

    @cached_property
    def jacobian(self) -> ca.SX:
        """``C = (∂Φ/∂y) A`` (4.13), with ``∂Ψ/∂v`` of nonholonomic equations."""
        return ca.sparsify(self.position_jacobian + self.slip_jacobian)

    @cached_property
    def position_jacobian(self) -> ca.SX:
        """``(∂Φ/∂y) A``, without entries in the rows of nonholonomic equations."""
        if self.kinematics is not None:
            return self.kinematics.jacobian
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
        """Rows of holonomic equations."""
        return tuple(k for k in range(self.constraint_count) if k not in self.slips)

    @cached_property
    def states(self) -> tuple[int, ...]:
        """Coordinates of first order, which have no displacements."""
        m = self.manifold
        if m.flat:
            return ()
        moving = set(ca.jacobian_sparsity(m.moved, m.delta).row())
        return tuple(k for k in range(self.coordinate_count) if k not in moving)

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
        if self.kinematics is not None:
            return self.kinematics.velocity
        return self.rate(self.constraints) + ca.densify(self.nonholonomic)

    @cached_property
    def constraint_acceleration(self) -> ca.SX:
        """``ξ = −(Ċ v + Φ̇_t)``, so that ``C v̇ = ξ`` (4.14)."""
        if self.kinematics is not None:
            return self.kinematics.acceleration
        return -self.rate(self.velocity_constraints)
