"""The recipe of a start: which equations, and which coordinates and speeds held at their guesses.

In the order of declaration (angles before positions), as many given coordinates as the constraints
leave independent are *held* at exactly their given values, so that a crank starts at the angle its
user wrote; the rest follows. This choice is made once; with it the assembled state is the root of
a square system and so a differentiable function of the parameters.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np
from scipy import sparse

from dalembert.model.assembly import ROUNDING, Assembler, factorised
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
        pattern, function = self._linear_speeds
        entries, right = (found.full().ravel() for found in function(t, y, p))
        n, scales = self.equations.speed_count, self.scales
        columns = np.full(right.size, scales.energy * scales.time)  # of σ, with natural equations
        columns[:n] = scales.speeds
        entries = entries * columns[pattern.columns]
        size = np.bincount(pattern.rows, np.abs(entries), right.size)
        rows = 1 / np.where(size > 0, size, 1.0)
        solve = factorised(pattern.matrix(entries * rows[pattern.rows]))
        return (columns * solve(rows * right))[:n]

    @cached_property
    def _linear_speeds(self) -> tuple[Pattern, ca.Function]:
        """``(t, y, p)`` → entries of the matrix and right-hand side of the speeds at the start."""
        e = self.equations
        unknown, equations = self._speed_equations()
        at_zero = ca.substitute(equations, unknown, ca.SX.zeros(unknown.numel()))
        matrix = ca.jacobian(equations, unknown)
        places = (np.array(matrix.row()), np.array(matrix.sparsity().get_col()))
        pattern = Pattern(*places, unknown.numel())
        outputs = [stack([ca.vec(matrix.nz[:])]), -at_zero]
        return pattern, ca.Function("linear_speeds", [e.t, e.y, e.p], outputs)

    def scaled_speed_jacobian(self, t: float, y: np.ndarray, p: np.ndarray) -> sparse.csr_array:
        """``∂Ψ/∂v`` of the demanded speeds, by speeds in natural units."""
        e = self.equations
        jacobian = ca.jacobian(self.demanded_speeds, e.v)
        function = ca.Function("speed_jacobian", [e.t, e.y, e.v, e.p], [jacobian])
        found = function(t, y, np.zeros(e.speed_count), p).sparse()
        return sparse.csr_array(found) @ sparse.diags_array(self.scales.speeds)


class Pattern:
    """Where the entries of a square matrix stand, given in any order.

    Parameters
    ----------
    rows, columns : of the entries
    size : of the matrix
    """

    def __init__(self, rows: np.ndarray, columns: np.ndarray, size: int):
        self.rows, self.columns = rows.astype(np.int32), columns.astype(np.int32)
        self._order = np.lexsort((self.rows, self.columns))
        ends = np.cumsum(np.bincount(self.columns, minlength=size)[:size])
        self._ends = np.concatenate([[0], ends]).astype(np.int32)
        self._shape = int(self.rows.max(initial=-1)) + 1, size

    def matrix(self, entries: np.ndarray) -> sparse.csc_array:
        """The matrix with these entries."""
        ordered = entries[self._order], self.rows[self._order], self._ends
        return sparse.csc_array(ordered, self._shape)


@dataclass(frozen=True)
class _Square(newton.Residual):
    """Residuals of a square system; ``entries`` are those of its Jacobian."""

    scale: np.ndarray
    entries: np.ndarray = field(kw_only=True)


class Pinned(newton.Equations[np.ndarray]):
    """The square system of an assembled position: independent equations, and what is held.

    Parameters
    ----------
    assembler, recipe : what is solved
    """

    longest: np.ndarray
    t: float
    p: np.ndarray
    targets: np.ndarray

    def __init__(self, assembler: Assembler, recipe: Recipe):
        self.assembler, self.recipe = assembler, recipe
        self.longest = assembler.longest
        self.held = np.array(recipe.positions.indices, dtype=int)
        beyond = range(assembler.equation_count, assembler.row_count)
        self.rows = np.array([*recipe.rows, *beyond], dtype=int)
        place = np.full(assembler.row_count, -1)
        place[self.rows] = np.arange(self.rows.size)
        self._kept = np.flatnonzero(place[assembler.entry_rows] >= 0)
        self._pattern = Pattern(
            np.concatenate(
                [
                    place[assembler.entry_rows[self._kept]],
                    self.rows.size + np.arange(self.held.size),
                ]
            ),
            np.concatenate([assembler.entry_columns[self._kept], self.held]),
            assembler.longest.size,
        )
        self._units = np.ones(self.held.size)
        self._sizes = assembler.scales.coordinates[self.held]

    def at(self, t: float, p: np.ndarray) -> Pinned:
        """The same at an instant, for parameter values."""
        made = copy(self)
        made.t, made.p = t, p
        made.targets = self.recipe.positions.targets(self.recipe.guesses.values(p)[0])
        return made

    def residual(self, x: np.ndarray) -> _Square:
        value, scale, rounding, entries = self.assembler.violations(self.t, x, self.p)
        rows = self.rows
        return _Square(
            np.concatenate([value[rows], x[self.held] - self.targets]),
            np.concatenate([scale[rows], self._sizes]),
            np.concatenate([rounding[rows], ROUNDING * np.abs(self.targets)]),
            entries=np.concatenate([entries[self._kept], self._units]),
        )

    def step(self, x: np.ndarray, residual: newton.Residual) -> np.ndarray:
        assert isinstance(residual, _Square)
        columns, at = self.assembler.scales.coordinates, self._pattern
        scaled = residual.entries / residual.scale[at.rows] * columns[at.columns]
        return -columns * factorised(at.matrix(scaled))(residual.value / residual.scale)
