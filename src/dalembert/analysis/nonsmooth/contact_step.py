"""One time step with contacts: velocities, impulses, positions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.gaps import FormulaGaps, GapSource, Instant, SymbolicGap
from dalembert.analysis.nonsmooth.joined_gaps import selected_of, separating_of
from dalembert.analysis.nonsmooth.mean_gaps import mean_gaps
from dalembert.analysis.nonsmooth.mobility import Mobility
from dalembert.analysis.nonsmooth.smooth_motion import SmoothMotion
from dalembert.analysis.nonsmooth.step_state import StepResult, StepStart, warm_start
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.contact_laws import widest_groups
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.contacts import Contacts, FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.integrators.contact.impact_path import impact_impulses, in_succession
from dalembert.integrators.contact.impulses import Impulses
from dalembert.integrators.contact.schemes import Approach, ContactScheme
from dalembert.integrators.contact.static_friction import (
    STILL,
    may_stick,
    solve_with_static_friction,
    sticks,
)
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Matrix

ROUNDS = 50
"""Upper limit of the changes of the contact offsets in one step."""
AHEAD = 2.0
"""Search distance for gaps in motions of a step; those beyond it are added where they close."""
REPETITIONS = 12
"""Upper limit of the solutions of a step that open gaps at its end."""
JAMMED = 1e-6
"""Upper limit of the residual relative to the speeds before the impulses, which may be large
without any effect where contacts jam [-]."""
GAIN = 1e-10
"""Work of contacts that counts as rounding, relative to that of their impulses alone [-]."""
CLOSED = 1e-12
"""Penetration that counts as rounding, by the natural length."""
APART = 2**54
"""Offset between the keys of gaps of different sources."""


@dataclass(frozen=True, eq=False)
class ContactStep:
    """Time steps of one model.

    Attributes
    ----------
    model : Model
    smooth, sources : functions of the model
    scheme, solver : strategies
    p : (np,) parameters
    """

    model: Model
    smooth: SmoothMotion
    sources: list[GapSource]
    scheme: ContactScheme
    solver: ContactSolver
    p: np.ndarray

    @cached_property
    def groups(self) -> tuple[int, ...]:
        """Widths of the groups of tangential components of the relative velocities."""
        return widest_groups([source.groups for source in self.sources])

    @cached_property
    def law(self) -> ImpactLaw:
        """Law of restitution of all gaps.

        Raises
        ------
        UnsupportedError
            Gaps have several laws, or the scheme has not this law.
        """
        names = {source.law: source.elements[0].name for source in self.sources}
        if len(names) > 1:
            laws = " and ".join(f"{name} ({law.value})" for law, name in names.items())
            raise UnsupportedError(f"contacts have several laws of impact: {laws}; give one law")
        ((law, name),) = names.items()
        if law not in self.scheme.impact_laws:
            raise UnsupportedError(
                f"{name}: {type(self.scheme).__name__} has no {law.value} law of impact; use "
                f"integrator=da.MoreauJean(), or leave out {_keyword(self.sources, law)}"
            )
        return law

    def near(self, t: float, y: np.ndarray, travels: np.ndarray) -> Contacts:
        """Gaps of all sources within reach of the displacements ``travels``."""
        parts, elements = [], 0
        for number, source in enumerate(self.sources):
            contacts = source.near(t, y, self.p, travels, self.groups)
            parts.append(
                replace(
                    contacts, owner=contacts.owner + elements, key=contacts.key + number * APART
                )
            )
            elements += len(source.elements)
        return Contacts.joined(parts)

    def selected(self, t: float, y: np.ndarray, keys: np.ndarray) -> Contacts:
        """Gaps with some keys, at any distance."""
        gaps = selected_of(self.sources, APART, t, y, self.p, keys, self.groups)
        elements = np.cumsum([0, *(len(source.elements) for source in self.sources)])
        return replace(gaps, owner=gaps.owner + elements[keys // APART])

    def symbolic_gap(self, key: int) -> SymbolicGap:
        """The gap with a key, as formulas."""
        number, own = divmod(int(key), APART)
        return self.sources[number].symbolic(own)

    def deepest(self, t: float, y: np.ndarray) -> float:
        """The smallest gap if it is negative, else 0 [m]."""
        speeds = self.model.equations.speed_count
        return min(source.deepest(t, y, self.p, speeds) for source in self.sources)

    def closed(self, t: float, y: np.ndarray) -> Contacts:
        """Gaps that are negative by more than rounding."""
        contacts = self.near(t, y, np.zeros((self.model.equations.speed_count, 1)))
        return contacts.some(contacts.distance < -self.rounding)

    @property
    def rounding(self) -> float:
        """Penetration that counts as rounding [m]."""
        return CLOSED * self.model.scales.length

    def advance(
        self, t: float, h: float, y: np.ndarray, v: np.ndarray, before: StepResult | None
    ) -> StepResult:
        """A step of length ``h``; impulses of the step ``before`` are the starting point."""
        smooth = self.smooth.step(t, y, v, self.p, h, self.scheme.theta)
        start = StepStart(t, h, y, v, *smooth, before is None)
        contacts = self.near(t, y, AHEAD * h * np.column_stack([v, start.free]))
        if self.scheme.anticipates:
            return self._open(start, contacts, before)
        approach = start.approach(contacts, self.rounding)
        some = contacts.some(self.scheme.acting(approach))
        lifts = approach.forced > self.solver.tolerance * approach.fastest  # against forces
        if self.scheme.projection and lifts:
            return self._closed(start, some, before)
        return self._solved(start, some, before)

    def _solved(
        self, start: StepStart, contacts: Contacts, before: StepResult | None
    ) -> StepResult:
        """Solution for some contacts."""
        v, theta = start.v, self.scheme.theta
        approach = start.approach(contacts, self.rounding)
        impulses, stuck = self._impulses(approach, start.mobility, before)
        push = impulses.impulses.ravel()
        change, reactions = start.mobility(contacts.directions.T @ push)
        after = start.free + change
        displacement = start.h * (theta * after + (1 - theta) * v)
        position = self.model.equations.manifold.go(start.y, displacement)
        loss = -0.5 * float(push @ (contacts.directions @ (after + v)))
        multiplier = start.multiplier + reactions
        return StepResult(position, after, multiplier, contacts, impulses, stuck, loss)

    def _closed(
        self, start: StepStart, contacts: Contacts, before: StepResult | None
    ) -> StepResult:
        """Solution in which the gaps that a correction would open have their impact, too."""
        result, end = self._solved(start, contacts, before), start.t + start.h
        for _ in range(REPETITIONS):
            if not np.isfinite(result.y).all() or self.deepest(end, result.y) >= -self.rounding:
                break
            keys = self.closed(end, result.y).key
            keys = keys[~np.isin(keys, contacts.key)]
            added = self.selected(start.t, start.y, keys)
            joined = start.approach(Contacts.joined([contacts, added]), self.rounding)
            if joined.is_impact:
                added = added.some(added.speeds(start.v)[:, 0] <= 0)
            if not added.count:
                break
            contacts = Contacts.joined([contacts, added])
            again = self._solved(start, contacts, result)
            push = again.impulses.impulses.ravel()
            exchanged = float(push @ (again.contacts.directions @ (again.v - start.free)))
            gains = again.loss < min(result.loss, -GAIN * exchanged)
            if gains or not again.impulses.accepted:
                break
            result = again
        return result

    def _open(self, start: StepStart, contacts: Contacts, before: StepResult | None) -> StepResult:
        """Solution whose gaps are open at the end of the step.

        Gaps that are closed there though their linear parts are open are replaced by their means
        over the path, and gaps that were beyond reach or of other features are added.
        """
        end, depth = start.t + start.h, np.inf
        overlaps = contacts.distance < -self.rounding
        contacts = replace(contacts, distance=np.maximum(contacts.distance, 0.0))
        result, curved = self._solved(start, contacts, before), np.zeros_like(overlaps)
        for _ in range(REPETITIONS):
            if not np.isfinite(result.y).all():
                break
            last, depth = depth, -self.deepest(end, result.y)
            if depth <= self.rounding:
                break
            added = self._added(start, (end, result.y), contacts)
            if start.begins and depth >= last and not added.count:
                break  # an impact, which has no earlier step to prepare for it
            contacts = Contacts.joined([contacts, added])
            none = np.zeros(added.count, dtype=bool)
            overlaps, curved = np.append(overlaps, none), np.append(curved, none)
            curved |= self.selected(end, result.y, contacts.key).distance < -self.rounding
            curved &= ~overlaps
            again = self._solved_on_path(start, contacts, curved, result)
            if not again.impulses.accepted:
                break
            result = again
        return result

    def _added(self, start: StepStart, end: Instant, contacts: Contacts) -> Contacts:
        """Gaps in addition to ``contacts`` of shapes that overlap at the end.

        Features may change within the step. The gaps that are closed at its start are replaced by
        those that separate the shapes there, or, without any, count if forces can open them.
        """
        keys, at = self.closed(*end).key, (start.t, start.y)
        gaps = self.selected(*at, keys[~np.isin(keys, contacts.key)])
        closed = gaps.distance < -self.rounding
        own = self.p, gaps.key[closed], self.rounding
        separating = separating_of(self.sources, APART, at, end, *own)
        if not separating.size:
            approach = start.approach(Contacts.joined([contacts, gaps]), self.rounding)
            closed &= gaps.distance < -start.h * approach.forced / 2
        joined = Contacts.joined([gaps.some(~closed), self.selected(*at, separating)])
        return joined.some(~np.isin(joined.key, contacts.key))

    def _solved_on_path(
        self, start: StepStart, contacts: Contacts, curved: np.ndarray, last: StepResult
    ) -> StepResult:
        """Solution with means over the path of the last one for curved gaps."""
        keys = contacts.key[curved]
        mean = mean_gaps(
            lambda t, y: self.selected(t, y, keys),
            self.model.equations.manifold,
            (start.t, start.h),
            start.y,
            start.h * (last.v + start.v) / 2,
        )
        path = Contacts.joined([contacts.some(~curved), mean])
        return replace(self._solved(start, path, last), curved=np.sort(keys))

    def _impulses(
        self, approach: Approach, mobility: Mobility, before: StepResult | None
    ) -> tuple[Impulses, np.ndarray]:
        """Impulses of the contacts, and keys of the sticking ones with static friction; offsets are
        updated until they no longer change."""
        contacts, shape = approach.contacts, approach.before.shape
        if not contacts.count:
            return Impulses(np.zeros(shape), 0.0, True), contacts.key[:0]
        matrix = delassus(contacts.directions, mobility)
        offsets, free = self.scheme.first(approach), approach.free
        laws, none = contacts.laws, contacts.key[:0]
        scale = approach.fastest or 1.0
        rounding = STILL * self.solver.tolerance * scale
        static = may_stick(contacts, approach.before, before.stuck if before else none, rounding)
        start, rounds = warm_start(contacts, before, shape), 0
        impact = None
        if self.law is not ImpactLaw.NEWTON and approach.is_impact:
            friction = laws.friction, contacts.groups, scale
            instant = FrictionProblem(matrix, approach.before, *friction)
            impact, at_end = impact_impulses(instant, laws.restitution, self.law, self.solver)
            parting = approach.before[:, 0] > 0
            free, held = free + at_end - approach.before, approach.held(at_end)
            offsets = np.where(parting[:, None], np.maximum(held, offsets), held)
        for _ in range(ROUNDS):
            velocity = free + offsets
            problem = FrictionProblem(matrix, velocity, laws.friction, contacts.groups, scale)
            state = laws, static, approach.before
            solution, static = solve_with_static_friction(self.solver, problem, start, *state)
            if solution.converged and solution.residual > JAMMED * scale:
                none_yet = np.zeros_like(start)
                solution, static = solve_with_static_friction(
                    self.solver, problem, none_yet, *state
                )
                jammed = solution.residual > JAMMED * scale
                solution = replace(solution, accepted=solution.accepted and not jammed)
            start, rounds = solution.impulses, rounds + solution.rounds
            after = problem.speeds(solution.impulses) - offsets
            changed = self.scheme.again(approach, offsets, solution.impulses, after)
            if changed is None or not solution.accepted:
                break
            offsets = changed
        stuck = none
        if laws.higher_at_rest.any():
            stuck = contacts.key[(start[:, 0] > 0) & sticks(self.solver, problem, solution)]
        solution = replace(solution, rounds=rounds)
        return solution if impact is None else in_succession(impact, solution), stuck


def _keyword(sources: list[GapSource], law: ImpactLaw) -> str:
    """Argument of the element that requests a law."""
    formulas = any(isinstance(source, FormulaGaps) for source in sources)
    return "poisson=True" if formulas else f"impact_law={law.value!r}"


def delassus(directions: Matrix, mobility: Mobility) -> np.ndarray | Delassus:
    """``W A⁻¹ Wᵀ``, as an operator if the directions are sparse."""
    responses = mobility.responses(directions)
    if not scipy.sparse.issparse(directions):
        return np.asarray(directions @ responses.T)
    none = np.zeros(directions.shape[0])
    return Delassus(directions, responses, mobility.matrix, mobility.joints, none)
