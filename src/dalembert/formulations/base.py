"""Contract of formulations: methods that solve the saddle system of (5.7).

    ⎡M  Cᵀ⎤ ⎡v̇⎤   ⎡f − d⎤
    ⎣C  0 ⎦ ⎣λ ⎦ = ⎣  ξ  ⎦

All formulations are algebraically equivalent; they differ in the elimination and in the systems
they support. A formulation is one file with a ``SaddleSolver``. The equation that it satisfies,
and with it the exact derivatives of its result, are common to all and stated here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.inertia import Inertia
from dalembert.model.graph.rigid_gaps import headings
from dalembert.symbolic.equations.implicit import ImplicitFunction, Stage
from dalembert.symbolic.equations.semi_explicit import SemiExplicit, Sizes


class Level(IntEnum):
    """Number of differentiations of ``Φ``: ``Φ = 0``, ``Ψ = 0``, ``C v̇ = ξ``."""

    POSITION = 0
    SPEED = 1
    ACCELERATION = 2


NONE: frozenset[Level] = frozenset()


class SaddleSolver:
    """Solver of ``M x + Cᵀ z = r1``, ``C x − ρ z = r2`` for one factorisation.

    Built from ``M`` (n, n) and ``C`` (m, n).

    Attributes
    ----------
    softness : ``ρ``, zero if the constraints hold exactly
    """

    speed_count: int
    softness: ca.SX | float = 0.0

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        """``(x, z)``; the matrix is symmetric, so this is the transposed solve too."""
        raise NotImplementedError

    @property
    def corrector(self) -> SaddleSolver:
        """Solver with ``ρ = 0`` for corrections of a state; by default the solver itself."""
        return self

    def solve_stacked(self, rhs: ca.SX) -> ca.SX:
        n = self.speed_count
        return ca.vertcat(*self.solve(rhs[:n, :], rhs[n:, :]))

    def solve_transposed(self, rhs: ca.SX) -> ca.SX:
        """``solve_stacked`` with the transposed matrix; by default the matrix is symmetric."""
        return self.solve_stacked(rhs)


class Performance(NamedTuple):
    """Cost and accuracy of a formulation for one mechanism.

    Attributes
    ----------
    operations : number of operations of the accelerations and corrections of a step
    error : relative error of the initial accelerations
    """

    operations: int
    error: float


@dataclass(frozen=True)
class Formulation:
    """Strategy that computes accelerations and multipliers.

    A new formulation implements ``solver``; everything else has defaults.
    """

    @property
    def every_equation(self) -> bool:
        """Whether redundant equations and singular positions are supported."""
        return False

    @property
    def needs_mass(self) -> bool:
        """Whether it divides by masses that were nonzero when the model was built."""
        return True

    @property
    def gives_accelerations(self) -> bool:
        """Whether explicit methods can integrate it as ``ẋ = F(t, x, p)``."""
        return True

    @property
    def variables_per_row(self) -> int:
        """Number of algebraic variables per constraint equation in implicit integrators."""
        return 1

    def solver(self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]) -> SaddleSolver:
        """The factored saddle matrix."""
        raise NotImplementedError

    def saddle(self, e: Equations) -> SaddleSolver:
        """The solver of accelerations and multipliers."""
        return self.saddle_at(e, e.inertia, e.jacobian)

    def saddle_at(self, e: Equations, inertia: Inertia, jacobian: ca.SX) -> SaddleSolver:
        """The solver for ``M`` and ``C`` at another position."""
        return self.solver(inertia, jacobian, e.massless)

    def constraint_acceleration(self, e: Equations, xi: ca.SX) -> ca.SX:
        """``ξ`` with the terms that the formulation adds."""
        return xi

    @property
    def feedback(self) -> tuple[float, float] | None:
        """``(c₁, c₀)`` of ``Φ̈ + c₁Φ̇ + c₀Φ = 0`` if violations are fed back, else None."""
        return None

    @property
    def refuses_feedback(self) -> str:
        """The reason why violations cannot be fed back through ``ξ``; empty if they can."""
        return ""

    @property
    def exact_levels(self) -> frozenset[Level]:
        """Levels at which every state satisfies the constraints to round-off."""
        return frozenset({Level.ACCELERATION})

    @property
    def report(self) -> dict[str, float]:
        """Options that appear in the statistics of a run."""
        return {}

    def select(
        self, performance: Callable[[Formulation], Performance], implicit: bool
    ) -> Formulation:
        """The formulation to run: itself, unless it chooses one by ``performance``.

        Parameters
        ----------
        performance : evaluates a candidate
        implicit : whether the integrator solves equations in every step
        """
        return self

    # choices that depend on the position -------------------------------------------------
    def choose(self, e: Equations, t: float, y: np.ndarray, p: np.ndarray) -> Formulation:
        """The formulation with its choices for a position, e.g. a partition of the speeds."""
        return self

    def conditioning(self, e: Equations) -> tuple[ca.SX, float] | None:
        """Expression of (t, y, p) and the value above which ``choose`` is called again."""
        return None

    def consistent_speeds(self, e: Equations) -> Stage | None:
        """Stage whose unknowns replace ``v`` if not all speeds are states."""
        return None

    # equations for integrators ------------------------------------------------------------
    def acceleration(
        self,
        e: Equations,
        xi: ca.SX,
        outputs: list[ca.SX] | None = None,
        name: str = "acceleration",
        saddle: SaddleSolver | None = None,
    ) -> ImplicitFunction:
        """``(t, [y; v; w], p) → outputs`` of the accelerations and multipliers.

        Parameters
        ----------
        e : Equations
        xi : SX (m,), right-hand side ``ξ`` of ``C v̇ = ξ``, stabilised or not
        outputs : expressions of t, y, v, v̇, λ, p; by default ``[v̇, λ]``
        saddle : solver of the system, by default that of the formulation
        """
        c = e.jacobian
        xi = self.constraint_acceleration(e, xi)
        solver = self.saddle(e) if saddle is None else saddle
        unknown = ca.vertcat(e.a, e.multiplier)
        residual = ca.vertcat(
            e.inertia.times(e.a) + e.bias - e.force - e.rubbing + ca.mtimes(c.T, e.multiplier),
            ca.mtimes(c, e.a) - solver.softness * e.multiplier - xi,
        )
        value = ca.vertcat(*solver.solve(e.force - e.bias, xi))
        outputs = outputs or [e.a, e.multiplier]
        stages = []
        speeds = self.consistent_speeds(e)
        if speeds is not None:
            stages.append(speeds)
            residual, value, *outputs = ca.substitute(
                [residual, value, *outputs], [e.v], [speeds.unknown]
            )
        solves = solver.solve_stacked, solver.solve_transposed
        stages.append(Stage(unknown, residual, value, *solves))
        return ImplicitFunction(name, [e.t, state_symbols(e), e.p], stages, outputs)

    def semi_explicit(
        self, e: Equations, xi: ca.SX, saddle: SaddleSolver | None = None
    ) -> SemiExplicit:
        """Index-1 form (5.2): ``v̇`` and ``λ`` are algebraic, Newton's method eliminates them.

        ``saddle`` computes them at the start of a step, as in ``acceleration``.

        Raises
        ------
        UnsupportedError
            Redundant equations that hold exactly: their multipliers are not unique.
        """
        xi = self.constraint_acceleration(e, xi)
        softness = self.saddle(e).softness
        if self.every_equation and not isinstance(softness, ca.SX) and softness == 0:
            raise UnsupportedError(
                f"{type(self).__name__} solves redundant equations by its own iteration, which an "
                "implicit integrator does not run; use formulation=RangeSpace() or Penalty(), or "
                "an explicit integrator such as RK4()"
            )
        algebraic = ca.vertcat(
            dynamic_equations(e), ca.mtimes(e.jacobian, e.a) - softness * e.multiplier - xi
        )
        z = ca.vertcat(e.a, e.multiplier)
        level = (0,) * z.numel()
        xi_start = e.constraint_acceleration
        start = self.acceleration(e, xi_start, [z], "algebraic_start", saddle)
        sizes = sizes_of(e, [e.scales.multipliers], (0,))
        return SemiExplicit(
            e.t, state_symbols(e), z, e.p, state_rate(e), algebraic, level, level, 1, start, sizes
        )


def dynamic_equations(e: Equations) -> ca.SX:
    """``M v̇ + d − f + Cᵀ λ`` (4.22), minus the friction forces that depend on ``λ``."""
    return (
        e.inertia.times(e.a) + e.bias - e.force - e.rubbing + ca.mtimes(e.jacobian.T, e.multiplier)
    )


def state_symbols(e: Equations) -> ca.SX:
    """State ``x = [y; v; w; r; σ]``; ``w`` accumulates dissipated energy and energy input.

    Slip directions ``r`` on surfaces and the frozen branches ``σ`` of switching functions change
    between steps only.
    """
    return ca.vertcat(e.y, e.v, memory_symbols(e))


def memory_symbols(e: Equations) -> ca.SX:
    """The part of the state after coordinates and speeds."""
    return ca.vertcat(WORK, headings(e.contacts), e.switches.sides)


WORK = ca.SX.sym("work", 2)


def state_sizes(e: Equations) -> np.ndarray:
    """Natural sizes of the state."""
    s = e.scales
    energies = np.full(WORK.numel(), s.energy)
    frozen = np.ones(memory_symbols(e).numel() - WORK.numel())
    return np.concatenate([s.coordinates, s.speeds, energies, frozen])


def sizes_of(e: Equations, forces: list[np.ndarray], levels: tuple[int, ...]) -> Sizes:
    """Natural sizes of ``z = [v̇; forces]`` and of the equations, with constraints of given levels.

    Parameters
    ----------
    forces : sizes of the multipliers of each set of constraints
    levels : 0 for constraints on accelerations, 1 on speeds, 2 on positions
    """
    s = e.scales
    rows = [s.rows * s.time ** (level - 2) for level in levels]
    return Sizes(
        s.time,
        state_sizes(e),
        np.concatenate([s.speeds / s.time, *forces]),
        np.concatenate([s.efforts, *rows]),
    )


def state_rate(e: Equations) -> ca.SX:
    """``ẋ`` in terms of accelerations and multipliers."""
    frozen_count = memory_symbols(e).numel() - WORK.numel()
    return ca.vertcat(e.pose_rate, e.a, e.powers, ca.SX.zeros(frozen_count))
