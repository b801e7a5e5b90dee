"""Constrained equations as a differential-algebraic system for implicit integrators."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.formulations.base import (
    NONE,
    Formulation,
    Level,
    SaddleSolver,
    dynamic_equations,
    sizes_of,
    state_rate,
    state_symbols,
)
from dalembert.formulations.range_space import RangeSpaceSolver
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.inertia import Inertia
from dalembert.options import options
from dalembert.symbolic.equations.semi_explicit import SemiExplicit


@options
class DAE(Formulation):
    """``ẏ = A v``, ``M v̇ + d = f − Cᵀλ`` with the constraints at a chosen level.

    ===== ============================== ==========================================
    index constraint                     holds at the end of a step
    ===== ============================== ==========================================
    3     ``Φ = 0`` (5.1)                positions; speeds to the accuracy of the integrator
    2     ``Ψ = C v + Φ_t = 0``          speeds; positions drift slowly
    1     ``C v̇ = ξ`` (5.2)              accelerations only
    ===== ============================== ==========================================

    With ``stabilized`` the index-2 form satisfies the position constraints too (Gear, Gupta and
    Leimkuhler 1985): ``ẏ = A (v − M⁻¹Cᵀμ)`` with ``Φ = 0``; the exact ``μ`` is zero. With massless
    speeds ``M⁻¹`` is omitted.

    Reported accelerations and multipliers follow from ``C v̇ = ξ`` (5.7) at the computed states.

    Parameters
    ----------
    index : differentiation index 3, 2 or 1
    stabilized : satisfy position constraints as well as speed constraints, with ``index=2``

    Raises
    ------
    UnsupportedError
        Another index, or ``stabilized`` with another index than 2.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bob = system.add(planar.Particle("bob", mass=1.0, position=(1, 0)))
    >>> rod = system.add(planar.RigidLink("rod", system.ground.center, bob.center, length=1.0))
    >>> dae = da.DAE(index=2, stabilized=True)
    >>> motion = da.solve_dynamics(system.build(), 1.0, integrator=da.Radau(), formulation=dae)
    >>> bool(motion["position_violation"].max() < 1e-9)
    True
    """

    index: int = 3
    stabilized: bool = False

    def __post_init__(self) -> None:
        if self.index not in (1, 2, 3):
            raise UnsupportedError(
                f"DAE(index={self.index}): the index is 3 (positions), 2 (speeds) or "
                "1 (accelerations)"
            )
        if self.stabilized and self.index != 2:
            raise UnsupportedError(
                f"DAE(index={self.index}, stabilized=True): the stabilised form has index 2; use "
                "DAE(index=2, stabilized=True)"
            )

    @property
    def exact_levels(self) -> frozenset[Level]:
        level = {3: Level.POSITION, 2: Level.SPEED, 1: Level.ACCELERATION}[self.index]
        stabilized = {Level.POSITION} if self.stabilized else NONE
        return frozenset({level, Level.ACCELERATION} | stabilized)

    @property
    def refuses_feedback(self) -> str:
        """A reason for index 2 and 3, which do not contain ``ξ``."""
        return (
            ""
            if self.index == 1
            else (
                f"DAE(index={self.index}) has no equation ξ that Baumgarte could stabilise; use "
                "stabilization=Projection() or Stabilization(), or DAE(index=1)"
            )
        )

    @property
    def gives_accelerations(self) -> bool:
        return False

    @property
    def variables_per_row(self) -> int:
        return 2 if self.stabilized else 1

    def solver(
        self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]
    ) -> RangeSpaceSolver:
        return RangeSpaceSolver(inertia, jacobian, massless)

    def semi_explicit(
        self, e: Equations, xi: ca.SX, saddle: SaddleSolver | None = None
    ) -> SemiExplicit:
        """The system of the chosen index; ``z = [v̇; λ]``, with ``μ`` appended if stabilised."""
        n, m = e.speed_count, e.constraint_count
        rate, rows = state_rate(e), [dynamic_equations(e)]
        z, depth, lag = [e.a, e.multiplier], [0] * n, [0] * (n + m)
        if self.stabilized:
            mu = ca.SX.sym("mu", m)
            shifted = ca.substitute(e.pose_rate, e.v, e.v - self._shift(e, mu))
            rate = ca.vertcat(shifted, rate[shifted.numel() :])
            z, lag = [*z, mu], [*lag, *[1] * m]
        levels = {3: e.constraints, 2: e.velocity_constraints, 1: ca.mtimes(e.jacobian, e.a) - xi}
        chosen = (2, 3) if self.stabilized else (self.index,)
        slips = list(e.slips)
        for level in chosen:
            equations, depths = ca.SX(levels[level]), np.full(m, level - 1)
            if level == 3 and slips:  # nonholonomic rows exist at the level of speeds only
                equations[slips] = mu[slips] if self.stabilized else e.velocity_constraints[slips]
                depths[slips] = 1
            rows.append(equations)
            depth += depths.tolist()
        forces = [e.scales.multipliers]
        if self.stabilized:
            forces.append(self._shift_size(e))
        sizes = sizes_of(e, forces, tuple(level - 1 for level in chosen))
        start = [e.a, e.multiplier] + ([ca.SX.zeros(m)] if self.stabilized else [])
        return SemiExplicit(
            e.t,
            state_symbols(e),
            ca.vertcat(*z),
            e.p,
            rate,
            ca.vertcat(*rows),
            tuple(depth),
            tuple(lag),
            self.index,
            self.acceleration(
                e, e.constraint_acceleration, [ca.vertcat(*start)], "dae_start", saddle
            ),
            sizes,
        )

    @staticmethod
    def _shift_size(e: Equations) -> np.ndarray:
        """Natural size of ``μ``: an impulse, or a length or angle over a time without the mass."""
        s = e.scales
        return s.rows / s.time if e.massless else s.multipliers * s.time

    @staticmethod
    def _shift(e: Equations, mu: ca.SX) -> ca.SX:
        """Correction ``M⁻¹Cᵀμ`` of the speeds, normal to the constraints."""
        normal = ca.mtimes(e.jacobian.T, mu)
        return normal if e.massless else e.inertia.solve(normal)
