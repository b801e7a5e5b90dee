"""Recipe of the initial state: independent equations, and coordinates and speeds at their guesses.

In the order of declaration (rotations before positions), as many guessed coordinates as the
constraints leave independent are *fixed* at exactly their guesses, so that a crank starts at the
angle its user wrote; the rest follows. This choice is made once; with it the assembled state is
the root of a square system and so a differentiable function of the parameters.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np
import scipy

from dalembert.model.graph.assembly.assembly import ROUNDING, Assembler
from dalembert.model.graph.assembly.guesses import Guesses
from dalembert.model.graph.assembly.initial_states import InitialStates
from dalembert.model.graph.assembly.position import position_stages
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.scales import Scales
from dalembert.sparse.factorise import general_factors
from dalembert.symbolic.equations import newton
from dalembert.symbolic.equations.factor import QrFactor
from dalembert.symbolic.equations.implicit import ImplicitFunction, Stage
from dalembert.symbolic.formulas.expression import stack

INCONSISTENT = 1e-6
"""Threshold for inconsistent speeds: change relative to the guess plus its scale."""


@dataclass(frozen=True)
class FixedPositions:
    """Displacements fixed at zero, from the guess or else from the assembled position.

    Attributes
    ----------
    indices : of the displacements
    given : for each, whether it is measured from the guess
    anchor : the assembled position
    """

    indices: tuple[int, ...] = ()
    given: tuple[bool, ...] = ()
    anchor: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def away(self, e: Equations, guess: ca.SX) -> ca.SX:
        """Displacements from the fixed position, (k,) SX of y and p."""
        if not self.indices:
            return ca.SX(0, 1)
        from_guess = e.manifold.displacement(guess, e.y)
        from_anchor = e.manifold.displacement(ca.SX(self.anchor), e.y)
        pairs = zip(self.indices, self.given, strict=True)
        return stack((from_guess if given else from_anchor)[k] for k, given in pairs)


@dataclass(frozen=True)
class FixedSpeeds:
    """Speeds fixed at a constant, or at their guess if the constant is None."""

    indices: tuple[int, ...] = ()
    constants: tuple[float | None, ...] = ()

    @classmethod
    def of(cls, indices: list[int], given: list, values: np.ndarray) -> FixedSpeeds:
        """Speeds fixed at their guess if there is one, else at the value."""
        return cls(
            tuple(indices),
            tuple(None if given[k] is not None else float(values[k]) for k in indices),
        )

    def formulas(self, guess: list) -> list[ca.SX]:
        """Values at which they are fixed, from the guesses of all speeds."""
        pairs = zip(self.indices, self.constants, strict=True)
        return [guess[k] if c is None else ca.SX(c) for k, c in pairs]


@dataclass(frozen=True, eq=False)
class Recipe:
    """Equations and fixed values that determine the initial state of a mechanism.

    Attributes
    ----------
    rows : independent constraint equations
    position_conditions, speed_conditions : prescribed measures, (expression − value)
    positions, speeds : fixed values
    projected : whether inconsistent guesses of speeds are projected onto the constraints
    """

    equations: Equations
    guesses: Guesses
    scales: Scales
    rows: list[int]
    position_conditions: ca.SX
    speed_conditions: ca.SX
    positions: FixedPositions = field(default_factory=FixedPositions)
    speeds: FixedSpeeds = field(default_factory=FixedSpeeds)
    projected: bool = False

    @cached_property
    def states(self) -> InitialStates:
        """Values of the states of first order."""
        return InitialStates(self.equations, self.guesses)

    @property
    def position_rows(self) -> list[int]:
        """Rows of holonomic equations."""
        slips = set(self.equations.slips)
        return [k for k in self.rows if k not in slips]

    @cached_property
    def demanded_speeds(self) -> ca.SX:
        """``Ψ`` of the independent equations and the conditions on speeds."""
        return ca.vertcat(self.equations.velocity_constraints[self.rows, :], self.speed_conditions)

    @cached_property
    def pinned(self) -> ca.SX:
        """Displacements of fixed coordinates, zero at the start."""
        return self.positions.away(self.equations, self.guesses.place)

    @property
    def position_equations(self) -> tuple[ca.SX, np.ndarray]:
        """Residual of the assembled position, with its natural sizes."""
        e, s, rows = self.equations, self.scales, self.position_rows
        residual = ca.vertcat(e.constraints[rows, :], self.position_conditions, self.pinned)
        condition_sizes = np.full(self.position_conditions.numel(), s.length)
        fixed_sizes = s.displacements[list(self.positions.indices)]
        return residual, np.concatenate([s.rows[rows], condition_sizes, fixed_sizes])

    @cached_property
    def initial_state(self) -> ImplicitFunction:
        """``(t, y_start, p) → (y0, v0)`` with derivatives by ``p``.

        ``y_start`` is the assembled position itself; it only selects the point of differentiation.
        """
        e, states = self.equations, self.states
        start = ca.SX.sym("y_start", e.coordinate_count)
        position = position_stages(states.at_start, start, *self.position_equations)
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
        stages = [*position, velocity, *states.stages(start)]
        return ImplicitFunction("initial_state", [e.t, start, e.p], stages, [states.y, e.v])

    def _speed_equations(self) -> tuple[ca.SX, ca.SX]:
        """Unknowns, and equations linear in them, of the initial speeds."""
        e, demanded = self.equations, self.demanded_speeds
        targets = self.speeds.formulas(self.guesses.twist)
        if not self.projected:
            fixed = zip(self.speeds.indices, targets, strict=True)
            return e.v, ca.vertcat(demanded, stack(e.v[k] - target for k, target in fixed))
        c = ca.jacobian(demanded, e.v)
        sigma = ca.SX.sym("sigma", demanded.numel())
        balance = ca.mtimes(e.metric, e.v - stack(targets)) + ca.mtimes(c.T, sigma)
        return ca.vertcat(e.v, sigma), ca.vertcat(balance, demanded)

    def _speed_sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Natural sizes of the equations and unknowns of the initial speeds."""
        s = self.scales
        condition_sizes = np.full(self.speed_conditions.numel(), s.length / s.time)
        demanded = np.concatenate([s.rows[self.rows] / s.time, condition_sizes])
        if not self.projected:
            return np.concatenate([demanded, s.speeds[list(self.speeds.indices)]]), s.speeds
        impulses = np.concatenate([s.speeds, s.energy * s.time / (demanded * s.time)])
        return np.concatenate([s.efforts * s.time, demanded]), impulses

    def speeds_at(self, t: float, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(n,) initial speeds, by sparse factors."""
        pattern, function = self._linear_speeds
        entries, right = (output.full().ravel() for output in function(t, y, p))
        n, scales = self.equations.speed_count, self.scales
        columns = np.full(right.size, scales.energy * scales.time)  # of σ, with natural equations
        columns[:n] = scales.speeds
        entries = entries * columns[pattern.columns]
        size = np.bincount(pattern.rows, np.abs(entries), right.size)
        rows = 1 / np.where(size > 0, size, 1.0)
        factors = general_factors(pattern.matrix(entries * rows[pattern.rows]))
        return (columns * factors.solve(rows * right))[:n]

    @cached_property
    def _linear_speeds(self) -> tuple[Pattern, ca.Function]:
        """``(t, y, p)`` → entries of the matrix and right-hand side of the initial speeds."""
        e = self.equations
        unknown, equations = self._speed_equations()
        at_zero = ca.substitute(equations, unknown, ca.SX.zeros(unknown.numel()))
        matrix = ca.jacobian(equations, unknown)
        places = (np.array(matrix.row()), np.array(matrix.sparsity().get_col()))
        pattern = Pattern(*places, unknown.numel())
        outputs = [stack([ca.vec(matrix.nz[:])]), -at_zero]
        return pattern, ca.Function("linear_speeds", [e.t, e.y, e.p], outputs)

    def scaled_speed_jacobian(
        self, t: float, y: np.ndarray, p: np.ndarray
    ) -> scipy.sparse.csr_array:
        """``∂Ψ/∂v`` of the demanded speeds, by speeds in natural units."""
        e = self.equations
        jacobian = ca.jacobian(self.demanded_speeds, e.v)
        function = ca.Function("speed_jacobian", [e.t, e.y, e.v, e.p], [jacobian])
        matrix = function(t, y, np.zeros(e.speed_count), p).sparse()
        return scipy.sparse.csr_array(matrix) @ scipy.sparse.diags_array(self.scales.speeds)


class Pattern:
    """Sparsity pattern of a square matrix with entries in any order.

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

    def matrix(self, entries: np.ndarray) -> scipy.sparse.csc_array:
        """The matrix with these entries."""
        ordered = entries[self._order], self.rows[self._order], self._ends
        return scipy.sparse.csc_array(ordered, self._shape)


@dataclass(frozen=True)
class Square(newton.Residual):
    """Residuals of a square system; ``entries`` are those of its Jacobian."""

    scale: np.ndarray
    entries: np.ndarray = field(kw_only=True)


class Pinned(newton.Equations[np.ndarray]):
    """Square system of an assembled position: independent equations and fixed coordinates.

    Parameters
    ----------
    assembler, recipe : Assembler, Recipe
    """

    longest: np.ndarray
    t: float
    p: np.ndarray

    def __init__(self, assembler: Assembler, recipe: Recipe):
        self.assembler, self.recipe = assembler, recipe
        self.longest = assembler.longest
        e, pinned = recipe.equations, recipe.pinned
        by_row = e.by_displacement(pinned).T
        entries = stack([ca.vec(by_row.nz[:])])
        self.fixed_count = len(recipe.positions.indices)
        self.fixed_columns, ends = np.array(by_row.row(), dtype=int), np.array(by_row.colind())
        self.fixed_rows = np.repeat(np.arange(self.fixed_count), np.diff(ends))
        far = ca.mtimes(ca.fabs(e.lift).T, ca.fabs(e.y))
        far = ca.mtimes(ca.fabs(e.by_displacement(pinned)), far)
        self.fixed_at = ca.Function("fixed", [e.y, e.p], [pinned, entries, ca.densify(far)])
        beyond = range(assembler.equation_count, assembler.row_count)
        self.rows = np.array([*recipe.position_rows, *beyond], dtype=int)
        place = np.full(assembler.row_count, -1)
        place[self.rows] = np.arange(self.rows.size)
        self._selected = np.flatnonzero(place[assembler.entry_rows] >= 0)
        selected_rows = place[assembler.entry_rows[self._selected]]
        self._pattern = Pattern(
            np.concatenate([selected_rows, self.rows.size + self.fixed_rows]),
            np.concatenate([assembler.entry_columns[self._selected], self.fixed_columns]),
            assembler.longest.size,
        )
        self.sizes = assembler.scales.displacements[list(recipe.positions.indices)]

    def at(self, t: float, p: np.ndarray) -> Pinned:
        """The system at an instant, for parameter values."""
        system = copy(self)
        system.t, system.p = t, p
        return system

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        return self.assembler.displaced(x, step)

    def residual(self, x: np.ndarray) -> Square:
        value, scale, rounding, entries = self.assembler.violations(self.t, x, self.p)
        away, fixed_entries, far = (output.full().ravel() for output in self.fixed_at(x, self.p))
        rows = self.rows
        return Square(
            np.concatenate([value[rows], away]),
            np.concatenate([scale[rows], self.sizes]),
            np.concatenate([rounding[rows], ROUNDING * far]),
            entries=np.concatenate([entries[self._selected], fixed_entries]),
        )

    def step(self, x: np.ndarray, residual: newton.Residual) -> np.ndarray:
        assert isinstance(residual, Square)
        columns, at = self.assembler.scales.displacements, self._pattern
        scaled = residual.entries / residual.scale[at.rows] * columns[at.columns]
        factors = general_factors(at.matrix(scaled))
        return -columns * factors.solve(residual.value / residual.scale)
