"""How a mechanism closes: independent equations, held coordinates, the assembled state.

Made once for the nominal parameters; then the assembled state follows the parameters on the same
branch, as a differentiable function of them.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.elements.base import Constraint, ForceElement, rate_of
from dalembert.elements.planar.drivers import Driver
from dalembert.errors import AssemblyError, ModelError, SingularityError
from dalembert.model.absolute import at_ground
from dalembert.model.assembly import (
    POSITION_TOLERANCE,
    AssembledState,
    Assembler,
)
from dalembert.model.description import Description
from dalembert.model.equations import Equations
from dalembert.model.guesses import Guesses
from dalembert.model.independence import independent_rows
from dalembert.model.natural_units import scales_of
from dalembert.symbolic.expression import free_symbols, stack, t
from dalembert.symbolic.implicit import ImplicitFunction


class Closure:
    """Assembly of one mechanism.

    Parameters
    ----------
    description, equations : with all constraint rows
    nominal : (np,) parameter values
    strict : refuse inconsistent initial speeds instead of projecting them

    Attributes
    ----------
    scales : Scales of the mechanism
    owners : (m,) constraint and component behind each row
    rows : independent constraint rows
    jacobian : ``C`` of all rows at the assembled position

    Raises
    ------
    AssemblyError, SingularityError, ModelError
        It cannot be closed, stands in a singular position, is over-driven or undefined.
    """

    def __init__(
        self, description: Description, equations: Equations, nominal: np.ndarray, strict: bool
    ):
        self.description, self.all_equations, self.nominal = description, equations, nominal
        self.owners: list[tuple[Constraint, int]] = [
            (c, k) for c in description.constraints for k in range(c.equations.numel())
        ]
        self.guesses = Guesses.collect(description.coordinates)
        self.scales = scales_of(description, equations, self.guesses, nominal)
        self._assembler = Assembler(
            equations,
            self.guesses,
            [c.name for c, _ in self.owners],
            [self._fixed(m.sx - v.sx) for m, v in description.initial_conditions],
            self._curve_searches(),
        )
        self._close(strict)

    def _fixed(self, expression: ca.SX) -> ca.SX:
        return at_ground(self.description.ground, expression)

    def _curve_searches(self) -> list[tuple[int, list[int], tuple[float, float]]]:
        """Curve parameters without a guess: coordinate, equations, range."""
        found = []
        for constraint in self.description.constraints:
            for part in constraint.own_coordinates():
                if part.guesses()[0][0] is None:
                    index = self.guesses.owners.index(part.name)
                    rows = [k for k, (c, _) in enumerate(self.owners) if c is constraint]
                    found.append((index, rows, part.interval))
        return found

    def _close(self, strict: bool) -> None:
        assembler, p = self._assembler, self.nominal
        y_size = self.all_equations.coordinate_count
        try:
            y = assembler.project(0.0, p)
        except AssemblyError:  # too many drivers is the better explanation, if it is one
            drivers = [k for k, (c, _) in enumerate(self.owners) if isinstance(c, Driver)]
            freedom = y_size - (len(self.owners) - len(drivers))
            if 1 <= freedom < len(drivers):
                self._refuse_over_driving(sorted(set(range(len(self.owners))) - {drivers[-1]}))
            raise
        self._refuse_undefined(y, p)
        jacobian = self._joint_jacobian(0.0, y)
        rows = independent_rows(jacobian)
        if len(rows) < jacobian.shape[0]:
            rows = self._rows_nearby(y, p, rows)
        self.rows = rows
        self._refuse_over_driving(rows)
        y = self._hold_positions(y, p)
        self._anchor = (p.copy(), y)
        self.held_speeds, miss = assembler.choose_held_speeds(0.0, y, p, rows)
        if miss and strict:
            name, value = max(miss.items(), key=lambda item: abs(item[1]))
            raise AssemblyError(
                f"initial speeds are inconsistent with the joints: {name} would have to change by "
                f"{value:.3g}; correct them, or build without strict",
                abs(value),
            )
        self.projected_speeds = bool(miss)
        self.start = self.assemble(p)
        self.jacobian = jacobian

    def _hold_positions(self, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Hold as many given coordinates as can be had, the first ones first."""
        free: set[int] = set()
        while True:
            self.held = self._assembler.choose_held(0.0, y, p, self.rows, free)
            self._square = self._make_square()
            wanted = [
                k for k, c in zip(self.held.indices, self.held.constants, strict=True) if c is None
            ]
            try:
                return self._follow(p, y, p, 0.0)
            except AssemblyError:
                if not wanted:
                    raise
                free.add(wanted[0])

    @cached_property
    def _jacobian_function(self) -> ca.Function:
        e = self.all_equations
        return ca.Function("C", [e.t, e.y, e.p], [e.jacobian])

    def _joint_jacobian(self, time: float, y: np.ndarray) -> np.ndarray:
        return self._jacobian_function(time, y, self.nominal).full()

    def _rows_nearby(self, y: np.ndarray, p: np.ndarray, rows: list[int]) -> list[int]:
        """Tell redundancy, which stays, from a singular position, which a small motion leaves.

        Raises
        ------
        SingularityError
            The start is a singular position: the motion from there is not determined.
        """
        joints = [k for k, (c, _) in enumerate(self.owners) if not isinstance(c, Driver)]
        jacobian = self._joint_jacobian(0.0, y)[joints]
        rank = len(independent_rows(jacobian))
        kernel = np.linalg.svd(jacobian)[2][rank:]
        rng = np.random.default_rng(1)
        for size in (1e-2, 1e-3) if kernel.size else ():
            moved = y + size * kernel.T @ rng.standard_normal(kernel.shape[0])
            moved, residual = self._assembler.close(0.0, moved, p, joints)
            if residual < 1e-10:
                generic = independent_rows(self._joint_jacobian(0.0, moved), 1e-7)
                if len(generic) > len(rows):
                    extra = ", ".join(
                        dict.fromkeys(self.owners[k][0].name for k in set(generic) - set(rows))
                    )
                    raise SingularityError(
                        "the start is a singular position (dead centre or branch point): "
                        f"{extra} lose their independence there; start a little beside it"
                    )
        return rows

    def _refuse_undefined(self, y: np.ndarray, p: np.ndarray) -> None:
        """Every element must have a value and a direction where the mechanism is assembled."""
        e = self.all_equations
        whole = stack([ca.vec(e.jacobian.nz[:]), e.force])
        if self._is_finite(whole, y, p):
            return
        for element in (*self.description.constraints, *self.description.forces):
            if not self._is_finite(self._definition(element), y, p):
                raise ModelError(
                    "has no defined direction or value at the assembled position (two points that "
                    "coincide, a root or a division by zero?); move its points or mend its formula",
                    element.name,
                )

    def _definition(self, element) -> ca.SX:
        """Directions and values an element is made of."""
        y = self.all_equations.y
        if not isinstance(element, ForceElement):
            return ca.vec(ca.jacobian(self._fixed(element.equations), y))
        owners = element.parts() or self.description.coordinates
        works = element.works(lambda s: rate_of(s, owners, t.sx))
        parts = [ca.vec(ca.jacobian(self._fixed(s), y)) for s, _ in works]
        return stack(parts + [self._fixed(q) for _, q in works])

    def _is_finite(self, column: ca.SX, y: np.ndarray, p: np.ndarray) -> bool:
        e = self.all_equations
        inputs = [e.t, e.y, e.v, e.p]
        if free_symbols(column) - free_symbols(ca.vertcat(*inputs)):
            return True  # accelerations or multipliers: nothing can be said before a run
        values = ca.Function("defined", inputs, [column])(0.0, y, np.zeros(y.size), p)
        return bool(np.all(np.isfinite(values.full())))

    def _refuse_over_driving(self, rows: list[int]) -> None:
        kept = set(rows)
        for k, (constraint, _) in enumerate(self.owners):
            if isinstance(constraint, Driver) and k not in kept:
                raise ModelError(
                    "drives a coordinate that the joints and other drivers already determine "
                    "(over-driven mechanism); remove this driver or another one",
                    constraint.name,
                )

    def assemble(self, p: np.ndarray, time: float = 0.0) -> AssembledState:
        """Consistent initial state for parameter values ``p``, on the branch of the nominal one.

        Raises
        ------
        AssemblyError
            Names the worst joint and its residual.
        """
        anchor_p, anchor_y = self._anchor
        y = self._follow(anchor_p, anchor_y, p, time)
        state = self.initial_state.function(time, y, p)
        v = state[1].full().ravel()
        residual = np.abs(self._square(time, y, p)[0].full()).max(initial=0.0)
        guess_y, guess_v = (g.full().ravel() for g in self._assembler.guess(p))
        corrections = {
            name: float(y[k] - guess_y[k])
            for k, name in enumerate(self.guesses.names)
            if self.guesses.pose[k] is not None
        }
        changes = {
            name: float(v[k] - guess_v[k])
            for k, name in enumerate(self.guesses.names)
            if self.guesses.twist[k] is not None and self.projected_speeds
        }
        return AssembledState(y, v, float(residual), corrections, changes, self.projected_speeds)

    @cached_property
    def initial_state(self) -> ImplicitFunction:
        """``(t, y_start, p) → (y0, v0)`` as an implicit function of the parameters."""
        return self._assembler.initial_state(
            self.rows, self.held, self.held_speeds, self.projected_speeds
        )

    def _make_square(self) -> ca.Function:
        e = self.all_equations
        residual = self._assembler.position_residual(self.rows, self.held)
        return ca.Function("square", [e.t, e.y, e.p], [residual, ca.jacobian(residual, e.y)])

    def _follow(self, p0: np.ndarray, y0: np.ndarray, p1: np.ndarray, time: float) -> np.ndarray:
        """Newton from the nominal assembly; in smaller steps of time and parameters if need be."""
        reached, y, step = 0.0, y0, 1.0
        while reached < 1.0:
            target = min(1.0, reached + step)
            trial, residual = self._newton(target * time, y, p0 + target * (p1 - p0))
            if residual < POSITION_TOLERANCE:
                reached, y, step = target, trial, 2 * step
                continue
            step /= 2
            if step < 1e-3 / (1.0 + abs(time)):
                raise self._assembler.failure(target * time, trial, p0 + target * (p1 - p0))
        return y

    def _newton(self, time: float, y: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, float]:
        norm = np.inf
        for _ in range(25):
            r, jacobian = (a.full() for a in self._square(time, y, p))
            new = np.abs(r).max(initial=0.0)
            if not np.isfinite(new) or (new >= norm * 0.9 and norm < POSITION_TOLERANCE):
                break
            if new > 4 * norm:
                return y, float(norm)
            norm, best = new, y
            if norm < 1e-15:
                break
            try:
                delta = np.linalg.solve(jacobian, r.ravel())
            except np.linalg.LinAlgError:
                return y, float(norm)
            y = y - delta * min(1.0, 1.0 / max(np.abs(delta).max(initial=0.0), 1e-300))
        return best if np.isfinite(norm) else y, float(norm)
