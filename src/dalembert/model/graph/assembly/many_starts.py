"""Initial positions of a mechanism for many sets of parameters at once.

The square system of the start is solved by Newton's method for all sets, with one compiled step,
and by continuation from the nominal position if that fails, as ``continued`` and ``newton.solve``
do for a single set.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.model.graph.assembly.assembly import ROUNDING
from dalembert.model.graph.assembly.closure import Closure
from dalembert.model.graph.assembly.continuation import FOLLOWED, SHORTEST
from dalembert.model.graph.assembly.initial_states import SETTINGS, InitialStates
from dalembert.symbolic.equations.factor import QrFactor
from dalembert.symbolic.equations.many_newton import ManyEquations, Points, solve_many
from dalembert.symbolic.equations.newton import ROUNDING as ROUNDED, TINY
from dalembert.symbolic.once import once

Evaluate = Callable[..., list[np.ndarray]]
"""``(function, arguments …) → results``, with one row per set."""


class ManyStarts:
    """Assembled positions of a mechanism.

    Parameters
    ----------
    closure : Closure, with a regular start
    evaluate : evaluates compiled functions
    """

    def __init__(self, closure: Closure, evaluate: Evaluate):
        self.closure, self.evaluate = closure, evaluate

    def positions(self, p: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions on the branch of the nominal one.

        Parameters
        ----------
        p : (sets, np) parameters
        time : [s]

        Returns
        -------
        y : (sets, n) positions, or the last ones of Newton's method without convergence
        reached : (sets,) share of the path at which it failed; 1 otherwise
        found : (sets,) whether a position was found
        """
        count = len(p)
        first, anchor = self.closure.anchor
        y = np.tile(anchor, (count, 1))
        reached, step = np.zeros(count), np.ones(count)
        lost = np.zeros(count, dtype=bool)
        shortest = SHORTEST / (1.0 + abs(time) / self.closure.scales.time)
        while (going := np.flatnonzero((reached < 1.0) & ~lost)).size:
            target = np.minimum(1.0, reached[going] + step[going])
            here = first + target[:, None] * (p[going] - first)
            y[going] = self._with_states(y[going], here)
            equations = PinnedPositions(self.closure, self.evaluate, target * time, here)
            solutions = solve_many(equations, y[going], FOLLOWED)
            roots, accepted = solutions.points.x, solutions.accepted
            good, bad = going[accepted], going[~accepted]
            y[good], reached[good] = roots[accepted], target[accepted]
            step[good] *= 2
            step[bad] /= 2
            lost[bad] = step[bad] < shortest
            y[bad[lost[bad]]] = roots[~accepted][lost[bad]]
            reached[bad[lost[bad]]] = target[~accepted][lost[bad]]
        return y, reached, ~lost

    def _with_states(self, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Positions with the prescribed states of first order."""
        states = self.closure.recipe.states
        if not states.prescribed:
            return y
        return np.array([states.prescribed_at(*row) for row in zip(y, p, strict=True)])

    def with_steady_states(
        self, y: np.ndarray, time: float, p: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Positions with steady states of first order, and flags of those that have them."""
        states = self.closure.recipe.states
        if not (states.steady and len(y)):
            return y, np.ones(len(y), dtype=bool)
        t = np.full((len(y), 1), time)
        v = self.evaluate(initial_speeds(self.closure), t, y, p)[0]
        equations = ManySteadyStates(states, self.evaluate, (t, y, v, p))
        solutions = solve_many(equations, y[:, states.steady], SETTINGS)
        y = y.copy()
        y[:, states.steady] = solutions.points.x
        return y, solutions.accepted

    def gaps(self, t: float, y: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Index of the most violated equation, by natural sizes, and its violation.

        The index is −1 if there are only initial conditions.
        """
        equations = PinnedPositions(self.closure, self.evaluate, np.full(len(y), t), p)
        value = equations.points(y, np.arange(len(y))).value
        rows = self.closure.pinned.rows
        joints = rows < len(self.closure.owners)
        if not joints.any():
            return np.full(len(y), -1), np.abs(value).max(axis=1, initial=0.0)
        open_by = np.abs(value[:, : rows.size][:, joints])
        scales = self.closure.scales.rows[rows[joints]]
        worst = np.argmax(np.nan_to_num(open_by / scales, nan=np.inf), axis=1)
        return rows[joints][worst], open_by[np.arange(len(y)), worst]


@dataclass(eq=False)
class Positions(Points):
    """Positions with the residuals of the square system; ``following`` are those after a step."""

    following: np.ndarray


class PinnedPositions(ManyEquations[Positions]):
    """Square systems of the start at instants ``t`` (k,), for parameters ``p`` (k, np).

    Parameters
    ----------
    closure, evaluate : as in ``ManyStarts``
    """

    def __init__(self, closure: Closure, evaluate: Evaluate, t: np.ndarray, p: np.ndarray):
        self.closure, self.evaluate, self.t, self.p = closure, evaluate, t, p

    def points(self, x: np.ndarray, designs: np.ndarray) -> Positions:
        arguments = self.t[designs, None], x, self.p[designs]
        following, value, zero = self.evaluate(start_step(self.closure), *arguments)
        return Positions(x, value, zero, following)

    def steps(self, here: Positions, designs: np.ndarray) -> np.ndarray:
        """Positions after full steps."""
        return here.following

    def after(self, here: Positions, steps: np.ndarray, designs: np.ndarray) -> Positions:
        return self.points(steps, designs)


@dataclass(eq=False)
class Rates(Points):
    """Rates of steady states, and their Jacobian."""

    jacobian: np.ndarray


class ManySteadyStates(ManyEquations[Rates]):
    """States of first order whose rates are zero, as ``InitialStates.steady_at``.

    Parameters
    ----------
    states : InitialStates
    evaluate : as in ``ManyStarts``
    at : t, y, v, p, one row per set
    """

    def __init__(self, states: InitialStates, evaluate: Evaluate, at: tuple[np.ndarray, ...]):
        self.states, self.evaluate, self.at = states, evaluate, at

    def points(self, x: np.ndarray, designs: np.ndarray) -> Rates:
        at = (part[designs] for part in self.at)
        value, column = self.evaluate(self.states.columns, *at, x)
        count = x.shape[1]
        jacobian = column.reshape(-1, count, count).transpose(0, 2, 1)
        terms = np.einsum("kij,kj->ki", np.abs(jacobian), np.abs(x))
        scale = np.maximum(self.states.sizes[0], terms)
        return Rates(x, value, (SETTINGS.tolerance + ROUNDED) * scale, jacobian)

    def steps(self, here: Rates, designs: np.ndarray) -> np.ndarray:
        steps, matrix = np.full_like(here.x, np.nan), here.jacobian
        regular = np.isfinite(matrix).all(axis=(1, 2)) & (np.linalg.slogdet(matrix)[0] != 0)
        steps[regular] = -np.linalg.solve(matrix[regular], here.value[regular, :, None])[..., 0]
        return steps


@once
def initial_speeds(closure: Closure) -> ca.Function:
    """``(t, y, p) → v`` at assembled positions."""
    initial = closure.recipe.initial_state
    arguments = initial.function.sx_in()
    speeds = initial.function.call(arguments)[1]
    return ca.Function("initial_speeds", arguments, [ca.densify(speeds)], {"cse": True})


@once
def start_step(closure: Closure) -> ca.Function:
    """``(t, y, p) → y ⊕ δ, r, zero`` with ``δ`` of Newton's step."""
    pinned = closure.pinned
    assembler, recipe, e = pinned.assembler, pinned.recipe, pinned.recipe.equations
    conditions = [recipe.position_conditions] if recipe.position_conditions.numel() else []
    residual = ca.vertcat(e.constraints, *conditions)[pinned.rows.tolist(), :]
    rows = ca.vertcat(residual, recipe.pinned)
    jacobian = ca.vertcat(
        ca.vertcat(e.position_jacobian, *map(e.by_displacement, conditions))[
            pinned.rows.tolist(), :
        ],
        e.by_displacement(recipe.pinned),
    )
    scales = closure.scales
    fixed_sizes = scales.displacements[list(recipe.positions.indices)]
    constraint_rows = pinned.rows[pinned.rows < scales.rows.size]
    condition_count = pinned.rows.size - constraint_rows.size
    natural = np.concatenate(
        [scales.rows[constraint_rows], np.full(condition_count, scales.length), fixed_sizes]
    )
    size = ca.SX(natural)
    for k in range(constraint_rows.size, pinned.rows.size):  # conditions: the size of their terms
        along = ca.mtimes(ca.fabs(jacobian[k, :]), ca.SX(scales.displacements))
        size[k] = ca.if_else(along > 0, along, 1.0)
    far = ca.mtimes(ca.fabs(e.lift).T, ca.fabs(e.y))
    zero = FOLLOWED.tolerance * size + ROUNDING * ca.mtimes(ca.fabs(jacobian), far)
    delta = -QrFactor(jacobian, natural, scales.displacements).solve(rows)
    shares = ca.SX(assembler.longest) / ca.fmax(ca.fabs(delta), TINY)
    limited = [shares[int(k)] for k in np.flatnonzero(np.isfinite(assembler.longest))]
    shortened = ca.mmin(ca.vertcat(1.0, *limited))
    there = e.manifold.retract(e.y, delta * shortened)
    outputs = [ca.densify(x) for x in (there, rows, zero)]
    return ca.Function("start_step", [e.t, e.y, e.p], outputs, {"cse": True})
