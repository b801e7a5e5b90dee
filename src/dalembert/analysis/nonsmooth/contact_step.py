"""Solution of one time step with some contacts: velocities, impulses, positions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.gap_source import GapSource
from dalembert.analysis.nonsmooth.gaps.joined_gaps import selected_of, separating_of
from dalembert.analysis.nonsmooth.impact_stage import impact_stage
from dalembert.analysis.nonsmooth.mobility import Mobility, delassus
from dalembert.analysis.nonsmooth.smooth_motion import SmoothMotion
from dalembert.analysis.nonsmooth.step_state import StepResult, StepStart, warm_start
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.integrators.contact.approach import Approach
from dalembert.integrators.contact.contact_laws import widest_groups
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.contacts import Contacts, FrictionProblem
from dalembert.integrators.contact.impulses import Impulses
from dalembert.integrators.contact.schemes import ContactScheme
from dalembert.integrators.contact.static_friction import (
    STILL,
    may_stick,
    solve_with_static_friction,
    sticks,
)
from dalembert.model.graph.model import Model

ROUNDS = 50
"""Upper limit of the changes of the contact offsets in one step."""
JAMMED = 1e-6
"""Upper limit of the residual relative to the speeds before the impulses, which may be large
without any effect where contacts jam [-]."""
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

    def at(self, t: float, y: np.ndarray) -> Configuration:
        """The configuration with the parameters of the steps."""
        return Configuration(t, y, self.p)

    def near(self, configuration: Configuration, travels: np.ndarray) -> Contacts:
        """Gaps of all sources within reach of the displacements ``travels``."""
        parts, elements = [], 0
        for number, source in enumerate(self.sources):
            contacts = source.near(configuration, travels)
            parts.append(
                replace(
                    contacts, owner=contacts.owner + elements, key=contacts.key + number * APART
                )
            )
            elements += len(source.elements)
        return Contacts.joined(parts)

    def selected(self, configuration: Configuration, keys: np.ndarray) -> Contacts:
        """Gaps with some keys, at any distance."""
        gaps = selected_of(self.sources, APART, configuration, keys)
        elements = np.cumsum([0, *(len(source.elements) for source in self.sources)])
        return replace(gaps, owner=gaps.owner + elements[keys // APART])

    def separating(self, start: Configuration, end: Configuration, keys: np.ndarray) -> np.ndarray:
        """Keys of gaps between the shapes of the gaps ``keys`` that separate them at ``start`` and
        are closed at ``end``."""
        return separating_of(self.sources, APART, start, end, keys, self.rounding)

    def deepest(self, configuration: Configuration) -> float:
        """The smallest gap if it is negative, else 0 [m]."""
        return min(source.deepest(configuration) for source in self.sources)

    def closed(self, configuration: Configuration) -> Contacts:
        """Gaps that are negative by more than rounding."""
        contacts = self.near(configuration, np.zeros((self.model.equations.speed_count, 1)))
        return contacts.some(contacts.distance < -self.rounding)

    @property
    def rounding(self) -> float:
        """Penetration that counts as rounding [m]."""
        return CLOSED * self.model.scales.length

    def struck(self, start: StepStart, contacts: Contacts) -> StepStart:
        """The start with the impacts of some contacts by other laws than Newton's, if any."""
        if contacts.laws.follows(ImpactLaw.NEWTON).all():
            return start
        approach = start.approach(contacts, self.rounding)
        stage = impact_stage(approach, start.mobility, self.solver)
        return start if stage is None else start.after(stage)

    def late(self, start: StepStart, result: StepResult) -> np.ndarray:
        """Keys of the pressing contacts by other laws than Newton's that close fast, but take no
        part in the impacts of the start."""
        contacts = result.contacts
        other = ~contacts.laws.follows(ImpactLaw.NEWTON) & (result.impulses.impulses[:, 0] > 0)
        if not other.any():
            return contacts.key[:0]
        approach = start.approach(contacts, self.rounding)
        late: np.ndarray = contacts.key[other & approach.impacting & ~approach.hit]
        return late

    def solved(self, start: StepStart, contacts: Contacts, before: StepResult | None) -> StepResult:
        """A step with some contacts; impulses of the step ``before`` are the starting point."""
        v, theta = start.v, self.scheme.theta
        approach = start.approach(contacts, self.rounding)
        impulses, offsets, stuck = self._impulses(approach, start.mobility, before)
        momentum = contacts.directions.T @ impulses.impulses.ravel()
        change, reactions = start.mobility(momentum)
        after = start.free + change
        displacement = start.h * (theta * after + (1 - theta) * v)
        position = self.model.equations.manifold.go(start.y, displacement)
        if start.impact is not None:
            momentum = momentum + start.impact.momentum
            impulses = start.impact.added(contacts, impulses)
        loss = -0.5 * float(momentum @ (after + v))
        multiplier = start.multiplier + reactions
        return StepResult(position, after, multiplier, contacts, impulses, offsets, stuck, loss)

    def _impulses(
        self, approach: Approach, mobility: Mobility, before: StepResult | None
    ) -> tuple[Impulses, np.ndarray, np.ndarray]:
        """Impulses of the contacts, their offsets, which are updated until they no longer change,
        and keys of the sticking contacts with static friction."""
        contacts, shape = approach.contacts, approach.before.shape
        if not contacts.count:
            return Impulses(np.zeros(shape), 0.0, True), np.zeros(shape), contacts.key[:0]
        matrix = delassus(contacts.directions, mobility)
        offsets = self.scheme.first(approach)
        laws, none = contacts.laws, contacts.key[:0]
        scale = approach.fastest or 1.0
        rounding = STILL * self.solver.tolerance * scale
        static = may_stick(contacts, approach.before, before.stuck if before else none, rounding)
        start, rounds = warm_start(contacts, before, shape), 0
        for _ in range(ROUNDS):
            velocity = approach.free + offsets
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
        return replace(solution, rounds=rounds), offsets, stuck
