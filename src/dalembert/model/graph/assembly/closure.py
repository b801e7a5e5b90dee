"""Assembly of a mechanism: independent equations, fixed coordinates and the assembled state.

Both choices are made once, for the nominal parameters; the assembled state then follows the
parameters on the same branch, as a differentiable function of them.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from dalembert.elements.driver import Driver
from dalembert.errors import AssemblyError, ModelError, SingularityError
from dalembert.model.graph.absolute import at_ground
from dalembert.model.graph.assembly.assembly import Assembler
from dalembert.model.graph.assembly.continuation import BranchEnd, continued, lost_branch
from dalembert.model.graph.assembly.failure import failure
from dalembert.model.graph.assembly.guesses import AssembledState, Guesses
from dalembert.model.graph.assembly.independence import determine_dependent, free_columns, rows_of
from dalembert.model.graph.assembly.placement import curve_searches, loosely_facing, placed_guesses
from dalembert.model.graph.assembly.position_search import PositionSearch, SearchResult
from dalembert.model.graph.assembly.recipe import (
    INCONSISTENT,
    FixedPositions,
    FixedSpeeds,
    Pinned,
    Recipe,
)
from dalembert.model.graph.assembly.regularity import (
    Definedness,
    Owners,
    check_contradiction,
    check_over_driving,
    generic_rows,
)
from dalembert.model.graph.description import Description
from dalembert.model.graph.equations import Equations
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.formulas.expression import stack
from dalembert.symbolic.once import CacheOwner

STAYS_CLOSED = 1e-9
"""Threshold for the violation of a redundant equation, in natural sizes."""
MAX_SEARCHED = 140
"""Upper limit of coordinates for the search of other assemblies with fixed guesses."""
NEARBY = 1e-3
"""Threshold for displacements after which coordinates must be checked to be free, natural sizes."""


class Closure(CacheOwner):
    """Assembly of a mechanism.

    Parameters
    ----------
    description, equations : with all constraint rows
    nominal : (np,) parameter values
    strict : refuse inconsistent initial speeds instead of projecting them

    Attributes
    ----------
    owners : (m,) constraint and component of each row
    rows : independent constraint rows at the start
    generic : constraint rows that are independent almost everywhere; more than ``rows`` if the
        start is a singular position
    recipe : Recipe of the start
    assembler : Assembler, equations of positions
    jacobian : ``C`` of all rows at the assembled position, sparse, in natural units
    searched : SearchResult, if only a search from random starts could assemble it; else None
    anchor : nominal parameters and the assembled position for them, the start of continuation

    Raises
    ------
    AssemblyError, ModelError
        The mechanism cannot be assembled, is over-driven or undefined.
    """

    def __init__(
        self,
        description: Description,
        equations: Equations,
        guesses: Guesses,
        nominal: np.ndarray,
        strict: bool,
    ):
        self.description, self.all_equations, self.nominal = description, equations, nominal
        self.guesses, self.scales = guesses, equations.scales
        self.owners: Owners = description.rows
        self.searched: SearchResult | None = None
        self._close(strict)

    def _fixed(self, expression: ca.SX) -> ca.SX:
        return at_ground(self.description.ground, expression)

    def _close(self, strict: bool) -> None:
        d, e, p = self.description, self.all_equations, self.nominal
        conditions = self._fixed(stack(m.sx - v.sx for m, v in d.conditions))
        of_speed = np.array(ca.which_depends(conditions, e.v, 1, True), dtype=bool)
        positions, speeds = (
            conditions[np.flatnonzero(chosen).tolist(), :] for chosen in (~of_speed, of_speed)
        )
        searches = curve_searches(d, self.guesses)
        facing = self._fixed(stack(loosely_facing(d)))
        self.assembler = Assembler(
            e, self.guesses, placed_guesses(d), self.scales, positions, searches, facing
        )
        y = self._projected()
        Definedness(d, e, y, p).check()
        self.jacobian = self.assembler.scaled_jacobian(0.0, y, p)[: len(self.owners)]
        self.independence = rows_of(self.jacobian)
        self.rows = self.independence.pivots
        self.generic = self.rows
        if len(self.rows) < len(self.owners):
            self.generic = generic_rows(self.assembler, self.owners, self.rows, y, p)
        check_over_driving(self.owners, self.generic)
        self.recipe = Recipe(e, self.guesses, self.scales, self.rows, positions, speeds)
        self.anchor = p.copy(), self._hold_positions(y, p)
        self._hold_speeds(strict)
        self.start = self.assemble(p)
        left_out = sorted(set(range(len(self.owners))) - set(self.generic))
        if left_out and ca.depends_on(e.constraints, e.t):
            check_contradiction(e, self.owners, self.independence, left_out, self.start, p)

    def _raise_conditions(self, count: int, freedom: int) -> None:
        """Raise the error for more conditions on speeds than degrees of freedom."""
        raise ModelError(
            f"{count} conditions on speeds are prescribed at the start, but joints and drivers "
            f"leave {freedom} degrees of freedom; remove some, or give relaxed=False to a beam, "
            "which otherwise starts free of strain",
            self.description.name,
        )

    def _refuse_dependent_conditions(self, jacobian) -> None:
        """Raise the error for conditions on speeds that depend on joints and on each other."""
        if not self.recipe.speed_conditions.numel():
            return
        dependent = jacobian.shape[0] - len(rows_of(jacobian).pivots)
        if dependent:
            raise ModelError(
                f"{dependent} of the conditions on speeds at the start follow from the joints and "
                "the others; remove them, or give relaxed=False to a beam of each closed loop, "
                "which otherwise starts free of strain",
                self.description.name,
            )

    def _projected(self) -> np.ndarray:
        """The guesses, projected onto all constraints."""
        solution = self.assembler.project(0.0, self.nominal)
        if not solution.accepted:  # too many drivers are the better explanation, if they apply
            drivers = [k for k, (c, _) in enumerate(self.owners) if isinstance(c, Driver)]
            freedom = self.all_equations.speed_count - (len(self.owners) - len(drivers))
            if 1 <= freedom < len(drivers):
                remaining = sorted(set(range(len(self.owners))) - {drivers[-1]})
                check_over_driving(self.owners, remaining)
            return self._searched(solution.x)
        return solution.x

    def _searched(self, y: np.ndarray) -> np.ndarray:
        """The nearest assembled position to the guesses, from random starts."""
        p = self.nominal
        guess = self.assembler.start(0.0, p).full().ravel()
        searched = PositionSearch(self.assembler, self.description, 0.0, p).near(guess)
        for position in searched.positions:
            solution = self.assembler.close(0.0, position, p)
            if solution.accepted:
                self.searched = searched
                return solution.x
        raise failure(self.assembler, self.description, 0.0, y, p, searched)

    def _hold_positions(self, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Fix as many guessed coordinates as possible, in order of priority."""
        lost: set[int] = set()  # guesses that cannot be fixed count as missing
        d = self.description
        jacobian = self.assembler.scaled_jacobian(0.0, y, p)
        conditions = range(len(self.owners), jacobian.shape[0])
        while True:
            given = [g and k not in lost for k, g in enumerate(self.guesses.given)]
            priority = self.guesses.priority(given)
            chosen = free_columns(jacobian[[*self.recipe.position_rows, *conditions]], priority)
            held = FixedPositions(tuple(chosen), tuple(given[k] for k in chosen), y)
            self.recipe = replace(self.recipe, positions=held)
            self.pinned = Pinned(self.assembler, self.recipe)
            chosen_guesses = [k for k in chosen if given[k]]
            position, reached = continued(self.pinned, y, p, p, 0.0)
            if reached < 1.0 and not lost and y.size <= MAX_SEARCHED:
                other = PositionSearch(self.assembler, d, 0.0, p).keeping(y, self.pinned)
                if other is not None:
                    position, reached = other, 1.0
            if reached == 1.0:
                extremal = self._extremal(y, position, p, priority).intersection(chosen_guesses)
                if not extremal:
                    return position
                lost |= extremal
                continue
            if not chosen_guesses:
                raise failure(self.assembler, self.description, 0.0, position, p)
            lost.add(chosen_guesses[0])

    def _extremal(
        self, before: np.ndarray, y: np.ndarray, p: np.ndarray, priority: list[int]
    ) -> set[int]:
        """Fixed coordinates at an extremum, such as the height of an upright crank.

        Fixing them would determine neither the other coordinates nor their derivatives.
        """
        away = self.all_equations.manifold.lead(before, y) / self.scales.displacements
        if np.max(np.abs(away), initial=0.0) < NEARBY:
            return set()  # they are free where they were chosen
        jacobian = self.assembler.scaled_jacobian(0.0, y, p)
        conditions = range(len(self.owners), jacobian.shape[0])
        matrix = jacobian[[*self.recipe.position_rows, *conditions]]
        held = set(self.recipe.positions.indices)
        if determine_dependent(matrix, held):
            return set()
        return held - set(free_columns(matrix, priority))

    def _hold_speeds(self, strict: bool) -> None:
        """Fix guessed speeds; project them if they contradict each other."""
        p, y = self.anchor
        given, n = self.guesses.twist, self.all_equations.speed_count
        jacobian = self.recipe.scaled_speed_jacobian(0.0, y, p)
        if jacobian.shape[0] > n:
            self._raise_conditions(jacobian.shape[0] - len(self.rows), n - len(self.rows))
        self._refuse_dependent_conditions(jacobian)
        is_given = [speed is not None for speed in given]
        chosen = free_columns(jacobian, self.guesses.priority(is_given))
        self.recipe = replace(self.recipe, speeds=FixedSpeeds.of(chosen, given, np.zeros(n)))
        v, guess = self.recipe.speeds_at(0.0, y, p), self.guesses.speeds(y, p)
        allowed = INCONSISTENT * (self.scales.speeds + np.abs(guess))
        changes = {
            self.guesses.speed_names[k]: float(v[k] - guess[k])
            for k in range(n)
            if is_given[k] and abs(v[k] - guess[k]) > allowed[k]
        }
        if not changes:
            return
        if strict:
            name, value = max(changes.items(), key=lambda item: abs(item[1]))
            raise AssemblyError(
                f"initial speeds are inconsistent with the joints: {name} would have to change by "
                f"{value:.3g}; correct them, or build without strict",
                abs(value),
            )
        # the projection starts from the resulting values of missing speeds
        targets = FixedSpeeds.of(list(range(n)), given, v)
        self.recipe = replace(self.recipe, speeds=targets, projected=True)

    def state(self, y: np.ndarray, p: np.ndarray, time: float) -> AssembledState:
        """The initial state at an assembled position."""
        v = self.recipe.speeds_at(time, y, p)
        y = self.recipe.states.steady_at(time, y, v, p)
        residual = np.abs(self.pinned.at(time, p).residual(y).value).max(initial=0.0)
        guess_y, guess_v = self.guesses.values(p)[0], self.guesses.speeds(y, p)
        projected = self.recipe.projected
        is_given = [speed is not None for speed in self.guesses.twist]
        return AssembledState(
            y,
            v,
            float(residual),
            self._changes(self.guesses.given, self.all_equations.manifold.lead(guess_y, y)),
            self._changes(is_given, v - guess_v) if projected else {},
            projected,
        )

    def assemble(self, p: np.ndarray, time: float = 0.0) -> AssembledState:
        """Consistent initial state for parameter values ``p``, on the branch of the nominal one.

        Raises
        ------
        AssemblyError
            Names the worst joint and its residual.
        """
        anchor_p, anchor_y = self.anchor
        y = self._follow(anchor_p, anchor_y, p, time)
        if self.lost:  # equations left out at the start may not hold for other parameters
            left = self.assembler.residual(time, y, p)
            if np.max(np.abs(left.value) / left.scale, initial=0.0) > STAYS_CLOSED:
                raise failure(self.assembler, self.description, time, y, p)
        return self.state(y, p, time)

    @property
    def lost(self) -> str:
        """Joints that lose their independence in a singular position at the start, if any."""
        rows = sorted(set(self.generic) - set(self.rows))
        return ", ".join(dict.fromkeys(self.owners[k][0].name for k in rows))

    def refuse_singular_start(self, cure: str = "") -> None:
        """Check that the equations are independent at the start.

        Raises
        ------
        SingularityError
            The start is a singular position, from which the motion is not determined.
        """
        if self.lost:
            raise SingularityError(
                "the start is a singular position (dead centre or branch point): "
                f"{self.lost} lose their independence there; start near it{cure}"
            )

    def _changes(self, given: list[bool], change: np.ndarray) -> dict[str, float]:
        names = zip(self.guesses.speed_names, given, change, strict=True)
        return {name: float(value) for name, is_given, value in names if is_given}

    @property
    def initial_state(self) -> ImplicitFunction:
        """``(t, y_start, p) → (y0, v0)`` as an implicit function of the parameters.

        Raises
        ------
        SingularityError
            At a singular position, where it does not exist.
        """
        self.refuse_singular_start()
        return self.recipe.initial_state

    def _follow(self, p0: np.ndarray, y0: np.ndarray, p1: np.ndarray, time: float) -> np.ndarray:
        """The assembled position on the branch of a known one."""
        y0 = self.recipe.states.prescribed_at(y0, p1)
        y, reached = continued(self.pinned, y0, p0, p1, time)
        if reached < 1.0:
            end = BranchEnd(reached * time, p0 + reached * (p1 - p0), y)
            raise lost_branch(self.pinned, self.description, self.anchor, end, time, p1)
        return y
