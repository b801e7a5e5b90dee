"""What a formulation is: a way to solve the saddle system of (5.7).

    ⎡M  Cᵀ⎤ ⎡v̇⎤   ⎡f − d⎤
    ⎣C  0 ⎦ ⎣λ ⎦ = ⎣  ξ  ⎦

All formulations are algebraically equal; they differ in how they solve it and in what they can
take. A formulation writes one file with a ``SaddleSolver``; the equation it satisfies, and with
it the exact derivatives of its result, are common to all and stated here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.formulations.levels import Level
from dalembert.model.equations import Equations
from dalembert.model.inertia import Inertia
from dalembert.model.rigid_gaps import headings
from dalembert.symbolic.equations.implicit import ImplicitFunction, Stage
from dalembert.symbolic.equations.semi_explicit import SemiExplicit, Sizes


class SaddleSolver:
    """Solves ``M x + Cᵀ z = r1``, ``C x − ρ z = r2`` with factors that are computed once.

    Made from ``M`` (n, n) and ``C`` (m, n).

    Attributes
    ----------
    softness : ``ρ``, zero where the constraints hold exactly
    """

    speed_count: int
    softness: ca.SX | float = 0.0

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        """``(x, z)``; the matrix is symmetric, so this is its transposed solve too."""
        raise NotImplementedError

    @property
    def corrector(self) -> SaddleSolver:
        """The same factors with ``ρ = 0``, for corrections of a state; mostly the solver itself."""
        return self

    def solve_stacked(self, rhs: ca.SX) -> ca.SX:
        n = self.speed_count
        return ca.vertcat(*self.solve(rhs[:n, :], rhs[n:, :]))

    def solve_transposed(self, rhs: ca.SX) -> ca.SX:
        """``solve_stacked`` with the transposed matrix, which mostly is the same."""
        return self.solve_stacked(rhs)


class Merits(NamedTuple):
    """What a formulation costs on a mechanism, and how accurate it is there.

    Attributes
    ----------
    operations : of the accelerations and corrections of a step
    error : of the accelerations at the start, relative
    """

    operations: int
    error: float


@dataclass(frozen=True)
class Formulation:
    """Strategy object: how accelerations and multipliers are found.

    To write a new one, give ``solver``; the rest has defaults.
    """

    @property
    def every_equation(self) -> bool:
        """Takes redundant equations too, and passes through singular positions."""
        return False

    @property
    def needs_mass(self) -> bool:
        """Divides by masses that were not zero when the model was built."""
        return True

    @property
    def gives_accelerations(self) -> bool:
        """Can be integrated as ``ẋ = F(t, x, p)``, so by explicit methods."""
        return True

    @property
    def variables_per_row(self) -> int:
        """Algebraic variables of implicit integrators for every constraint equation."""
        return 1

    def solver(self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]) -> SaddleSolver:
        """Factors of the saddle matrix."""
        raise NotImplementedError

    def saddle(self, e: Equations) -> SaddleSolver:
        """The solver of accelerations and multipliers."""
        return self.saddle_at(e, e.inertia, e.jacobian)

    def saddle_at(self, e: Equations, inertia: Inertia, jacobian: ca.SX) -> SaddleSolver:
        """The solver for ``M`` and ``C`` at another position."""
        return self.solver(inertia, jacobian, e.massless)

    def constraint_acceleration(self, e: Equations, xi: ca.SX) -> ca.SX:
        """``ξ`` with what the formulation itself adds to it."""
        return xi

    @property
    def feedback(self) -> tuple[float, float] | None:
        """``(c₁, c₀)`` of ``Φ̈ + c₁Φ̇ + c₀Φ = 0`` where violations are fed back."""
        return None

    @property
    def refuses_feedback(self) -> str:
        """Why no violations can be fed back through ``ξ``; nothing where they can."""
        return ""

    @property
    def held(self) -> frozenset[Level]:
        """Levels at which every state satisfies the constraints, and not nearly so."""
        return frozenset({Level.ACCELERATION})

    @property
    def report(self) -> dict[str, float]:
        """Numbers of this choice that belong to the statistics of a run."""
        return {}

    def chosen(self, merits: Callable[[Formulation], Merits], implicit: bool) -> Formulation:
        """The one it stands for: itself, unless it is left to the ``merits`` of others.

        ``implicit`` tells of an integrator that solves equations in every step.
        """
        return self

    # choices that a run may change ------------------------------------------------------
    def choose(self, e: Equations, t: float, y: np.ndarray, p: np.ndarray) -> Formulation:
        """The formulation made definite for a position, e.g. with a partition of the speeds."""
        return self

    def conditioning(self, e: Equations) -> tuple[ca.SX, float] | None:
        """Expression of (t, y, p) and the value above which ``choose`` is asked again."""
        return None

    def consistent_speeds(self, e: Equations) -> Stage | None:
        """Stage whose unknowns replace ``v``, where not all speeds are states."""
        return None

    # what integrators are given -----------------------------------------------------------
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
        saddle : solver of the system, the formulation's own by default
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
        both = solver.solve_stacked, solver.solve_transposed
        stages.append(Stage(unknown, residual, value, *both))
        return ImplicitFunction(name, [e.t, state_symbols(e), e.p], stages, outputs)

    def semi_explicit(
        self, e: Equations, xi: ca.SX, saddle: SaddleSolver | None = None
    ) -> SemiExplicit:
        """Index-1 form (5.2): ``v̇`` and ``λ`` are algebraic, the elimination is left to Newton.

        ``saddle`` gives them where a step begins, as in ``acceleration``.

        Raises
        ------
        UnsupportedError
            Redundant equations that are to hold exactly: their multipliers have no unique value.
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
        own = e.constraint_acceleration
        start = self.acceleration(e, own, [z], "algebraic_start", saddle)
        sizes = sizes_of(e, [e.scales.multipliers], (0,))
        return SemiExplicit(
            e.t, state_symbols(e), z, e.p, state_rate(e), algebraic, level, level, 1, start, sizes
        )


def dynamic_equations(e: Equations) -> ca.SX:
    """``M v̇ + d − f + Cᵀ λ`` (4.22), less the friction that follows from ``λ``."""
    return (
        e.inertia.times(e.a) + e.bias - e.force - e.rubbing + ca.mtimes(e.jacobian.T, e.multiplier)
    )


def state_symbols(e: Equations) -> ca.SX:
    """State ``x = [y; v; w; r; σ]``; ``w`` accumulates dissipated energy and energy input.

    The directions ``r`` of slip over surfaces and the sides ``σ`` of switches that are held change
    between steps only.
    """
    return ca.vertcat(e.y, e.v, memory_symbols(e))


def memory_symbols(e: Equations) -> ca.SX:
    """What the state holds behind coordinates and speeds."""
    return ca.vertcat(WORK, headings(e.contacts), e.switches.sides)


WORK = ca.SX.sym("work", 2)


def state_sizes(e: Equations) -> np.ndarray:
    """Natural sizes of the state."""
    s = e.scales
    work, held = np.full(WORK.numel(), s.energy), np.ones(memory_symbols(e).numel() - WORK.numel())
    return np.concatenate([s.coordinates, s.speeds, work, held])


def sizes_of(e: Equations, forces: list[np.ndarray], levels: tuple[int, ...]) -> Sizes:
    """Natural sizes of ``z = [v̇; forces]`` and of the equations, constraints of some levels.

    Parameters
    ----------
    forces : sizes of the multipliers of every set of constraints
    levels : 0 where a set holds accelerations, 1 speeds, 2 positions
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
    held = memory_symbols(e).numel() - WORK.numel()
    return ca.vertcat(e.pose_rate, e.a, e.powers, ca.SX.zeros(held))
