"""The recipe of a start: which equations, and which coordinates and speeds held at their guesses.

In the order of declaration (angles before positions), as many given coordinates as the constraints
leave independent are *held* at exactly their given values, so that a crank starts at the angle its
user wrote; the rest follows. This choice is made once; with it the assembled state is the root of
a square system and so a differentiable function of the parameters.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np
from scipy import sparse

from dalembert.model.assembly import ROUNDING, Assembler, Closeness, factorised, scaled
from dalembert.model.equations import Equations
from dalembert.model.guesses import Guesses
from dalembert.model.scales import Scales
from dalembert.symbolic import newton
from dalembert.symbolic.expression import stack
from dalembert.symbolic.factor import QrFactor
from dalembert.symbolic.implicit import ImplicitFunction, Stage

INCONSISTENT = 1e-6
"""Change of a given speed, relative to it and to its scale, that is told."""


@dataclass(frozen=True)
class Held:
    """Coordinates or speeds held: at their guess where the constant is None, else at it."""

    indices: tuple[int, ...] = ()
    constants: tuple[float | None, ...] = ()

    @classmethod
    def of(cls, indices: list[int], given: list, values: np.ndarray) -> Held:
        """Held at the guess where one is given, else at the value."""
        return cls(
            tuple(indices),
            tuple(None if given[k] is not None else float(values[k]) for k in indices),
        )

    def targets(self, guess: np.ndarray) -> np.ndarray:
        """What they are held at, by the guesses of all coordinates."""
        pairs = zip(self.indices, self.constants, strict=True)
        return np.array([guess[k] if c is None else c for k, c in pairs])

    def formulas(self, guess: list) -> list[ca.SX]:
        """The same as formulas of parameters."""
        pairs = zip(self.indices, self.constants, strict=True)
        return [guess[k] if c is None else ca.SX(c) for k, c in pairs]


@dataclass(frozen=True, eq=False)
class Recipe:
    """What determines the start of a mechanism.

    Attributes
    ----------
    rows : independent constraint equations
    position_conditions, speed_conditions : prescribed measures, (expression − value)
    positions, speeds : what is held
    projected : the given speeds were inconsistent and are projected onto the constraints
    """

    equations: Equations
    guesses: Guesses
    scales: Scales
    rows: list[int]
    position_conditions: ca.SX
    speed_conditions: ca.SX
    positions: Held = field(default_factory=Held)
    speeds: Held = field(default_factory=Held)
    projected: bool = False

    @cached_property
    def demanded_speeds(self) -> ca.SX:
        """``Ψ`` of the independent equations and the conditions on speeds."""
        return ca.vertcat(self.equations.velocity_constraints[self.rows], self.speed_conditions)

    @cached_property
    def initial_state(self) -> ImplicitFunction:
        """``(t, y_start, p) → (y0, v0)`` with derivatives by ``p``.

        ``y_start`` is the assembled position itself; it only tells where to differentiate.
        """
        e = self.equations
        start = ca.SX.sym("y_start", e.coordinate_count)
        held = zip(self.positions.indices, self.positions.formulas(self.guesses.pose), strict=True)
        pinned = stack(e.y[k] - target for k, target in held)
        residual = ca.vertcat(e.constraints[self.rows], self.position_conditions, pinned)
        s = self.scales
        asked = np.full(self.position_conditions.numel(), s.length)
        rows = np.concatenate(
            [s.rows[self.rows], asked, s.coordinates[list(self.positions.indices)]]
        )
        factor = QrFactor(ca.jacobian(residual, e.y), rows, s.coordinates)
        position = Stage(e.y, residual, start, factor.solve, factor.solve_transposed)
        unknown, equations = self._speed_equations()
        speed_factor = QrFactor(ca.jacobian(equations, unknown), *self._speed_sizes())
        at_zero = ca.substitute(equations, unknown, ca.SX.zeros(unknown.numel()))
        velocity = Stage(
            unknown,
            equations,
            speed_factor.solve(-at_zero),
            speed_factor.solve,
            speed_factor.solve_transposed,
        )
        return ImplicitFunction(
            "initial_state", [e.t, start, e.p], [position, velocity], [e.y, e.v]
        )

    def _speed_equations(self) -> tuple[ca.SX, ca.SX]:
        """Unknowns and equations, linear in them, of the speeds at the start."""
        e, demanded = self.equations, self.demanded_speeds
        goal = self.speeds.formulas(self.guesses.twist)
        if not self.projected:
            held = zip(self.speeds.indices, goal, strict=True)
            return e.v, ca.vertcat(demanded, stack(e.v[k] - target for k, target in held))
        c = ca.jacobian(demanded, e.v)
        sigma = ca.SX.sym("sigma", demanded.numel())
        balance = ca.mtimes(e.metric, e.v - stack(goal)) + ca.mtimes(c.T, sigma)
        return ca.vertcat(e.v, sigma), ca.vertcat(balance, demanded)

    def _speed_sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Natural sizes of the same equations and unknowns."""
        s = self.scales
        asked = np.full(self.speed_conditions.numel(), s.length / s.time)
        demanded = np.concatenate([s.rows[self.rows] / s.time, asked])
        if not self.projected:
            return np.concatenate([demanded, s.speeds[list(self.speeds.indices)]]), s.speeds
        impulses = np.concatenate([s.speeds, s.energy * s.time / (demanded * s.time)])
        return np.concatenate([s.efforts * s.time, demanded]), impulses

    def speeds_at(self, t: float, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(n,) speeds at the start, by sparse factors."""
        matrix, right = self._linear_speeds(t, y, p)
        by_row = sparse.csr_array(matrix.sparse())
        n, scales = self.equations.speed_count, self.scales
        columns = np.ones(by_row.shape[1])
        columns[:n] = scales.speeds
        columns[n:] = scales.energy * scales.time  # of σ, for equations in natural units
        scaled = by_row @ sparse.diags_array(columns)
        rows = 1 / np.ravel(abs(scaled).max(axis=1).toarray())
        found = factorised(sparse.diags_array(rows) @ scaled)(rows * right.full().ravel())
        return (columns * found)[:n]

    @cached_property
    def _linear_speeds(self) -> ca.Function:
        """``(t, y, p)`` → matrix and right-hand side of the speeds at the start."""
        e = self.equations
        unknown, equations = self._speed_equations()
        at_zero = ca.substitute(equations, unknown, ca.SX.zeros(unknown.numel()))
        outputs = [ca.jacobian(equations, unknown), -at_zero]
        return ca.Function("linear_speeds", [e.t, e.y, e.p], outputs)

    def scaled_speed_jacobian(self, t: float, y: np.ndarray, p: np.ndarray) -> sparse.csr_array:
        """``∂Ψ/∂v`` of the demanded speeds, by speeds in natural units."""
        e = self.equations
        jacobian = ca.jacobian(self.demanded_speeds, e.v)
        function = ca.Function("speed_jacobian", [e.t, e.y, e.v, e.p], [jacobian])
        found = function(t, y, np.zeros(e.speed_count), p).sparse()
        return sparse.csr_array(found) @ sparse.diags_array(self.scales.speeds)


class Pinned(newton.Equations[np.ndarray]):
    """The square system of an assembled position: independent equations, and what is held.

    Parameters
    ----------
    assembler, recipe : what is solved
    guess : (n,) guesses of all coordinates for these parameter values
    t, p : instant and parameter values
    """

    longest: np.ndarray

    def __init__(
        self, assembler: Assembler, recipe: Recipe, guess: np.ndarray, t: float, p: np.ndarray
    ):
        self.assembler, self.t, self.p = assembler, t, p
        self.held = list(recipe.positions.indices)
        self.targets = recipe.positions.targets(guess)
        self.rows = [*recipe.rows, *range(assembler.equation_count, assembler.row_count)]
        self.longest = assembler.longest

    def residual(self, x: np.ndarray) -> Closeness:
        free = self.assembler.closeness(self.t, x, self.p).some(self.rows)
        units = sparse.csr_array(sparse.eye_array(x.size))[self.held]
        return Closeness(
            np.concatenate([free.value, x[self.held] - self.targets]),
            np.concatenate([free.scale, self.assembler.scales.coordinates[self.held]]),
            np.concatenate([free.rounding, ROUNDING * np.abs(self.targets)]),
            jacobian=sparse.vstack([free.jacobian, units], format="csr"),
        )

    def step(self, x: np.ndarray, residual: newton.Residual) -> np.ndarray:
        assert isinstance(residual, Closeness)
        columns = self.assembler.scales.coordinates
        solve = factorised(scaled(residual.jacobian, 1 / residual.scale, columns))
        return -columns * solve(residual.value / residual.scale)
