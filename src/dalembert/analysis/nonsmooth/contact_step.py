"""Solution of one time step with some contacts: velocities, impulses, positions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.compliant_contacts import CompliantContacts
from dalembert.analysis.nonsmooth.force_laws import ForceLaws
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.gap_source import FormulaGaps, GapSource
from dalembert.analysis.nonsmooth.gaps.joined_gaps import selected_of, separating_of
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
from dalembert.integrators.contact.impulses import Impulses, compliant_problem
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

    @cached_property
    def force_laws(self) -> ForceLaws:
        """Force laws of compliant contacts.

        Raises
        ------
        UnsupportedError
            The scheme has none.
        """
        laws, theta = ForceLaws(self.model, self.sources, self.p), self.scheme.theta
        if laws.elements and theta < 0.5:
            raise UnsupportedError(
                f"{laws.elements[0].name}: contacts with a force law need theta from 0.5 to 1; "
                f"it is {theta:g}"
            )
        return laws

    @cached_property
    def law(self) -> ImpactLaw:
        """Law of restitution of all gaps.

        Raises
        ------
        UnsupportedError
            Gaps have several laws, or the scheme has not this law.
        """
        compliant = self.force_laws.elements
        sources = [s for s in self.sources if s.elements[0] not in compliant] or self.sources
        names = {source.law: source.elements[0].name for source in sources}
        if len(names) > 1:
            laws = " and ".join(f"{name} ({law.value})" for law, name in names.items())
            raise UnsupportedError(f"contacts have several laws of impact: {laws}; give one law")
        ((law, name),) = names.items()
        if law not in self.scheme.impact_laws:
            raise UnsupportedError(
                f"{name}: {type(self.scheme).__name__} has no {law.value} law of impact; use "
                f"integrator=da.MoreauJean(), or leave out {_keyword(self.sources, law)}"
            )
        if compliant and law is not ImpactLaw.NEWTON:
            other = compliant[0].name
            raise UnsupportedError(
                f"{name} has the {law.value} law of impact and {other} a force law, which are not "
                f"available in one model; leave out {_keyword(self.sources, law)}"
            )
        return law

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
        """The smallest gap of rigid contacts if it is negative, else 0 [m]."""
        if self.force_laws.elements:
            gaps = self.rigid(self.touching(configuration))
            return float(gaps.distance.min(initial=0.0))
        return min(source.deepest(configuration) for source in self.sources)

    def closed(self, configuration: Configuration) -> Contacts:
        """Gaps of rigid contacts that are negative by more than rounding."""
        contacts = self.rigid(self.touching(configuration))
        return contacts.some(contacts.distance < -self.rounding)

    def touching(self, configuration: Configuration) -> Contacts:
        """Gaps that are not open."""
        return self.near(configuration, np.zeros((self.model.equations.speed_count, 1)))

    def rigid(self, contacts: Contacts) -> Contacts:
        """Those of the contacts that have no force law."""
        compliant = self.force_laws.compliant(contacts)
        return contacts.some(~compliant) if compliant.any() else contacts

    @property
    def rounding(self) -> float:
        """Penetration that counts as rounding [m]."""
        return CLOSED * self.model.scales.length

    def solved(self, start: StepStart, contacts: Contacts, before: StepResult | None) -> StepResult:
        """A step with some contacts; impulses of the step ``before`` are the starting point."""
        v, theta = start.v, self.scheme.theta
        approach = start.approach(contacts, self.rounding)
        impulses, offsets, stuck, compliant = self._impulses(approach, start.mobility, before)
        push = impulses.impulses.ravel()
        change, reactions = start.mobility(contacts.directions.T @ push)
        after = start.free + change
        displacement = start.h * (theta * after + (1 - theta) * v)
        position = self.model.equations.manifold.go(start.y, displacement)
        mean = 0.5 * (contacts.directions @ (after + v)).reshape(offsets.shape)
        ends = contacts.speeds(after)[:, 0]
        loss = -float(push @ mean.ravel()) - compliant.stored(ends)
        work = np.zeros(contacts.count)
        work[compliant.rows] = (impulses.impulses * mean)[compliant.rows, 0]
        solution = contacts, impulses, offsets, stuck, loss, work, compliant.fractions(ends)
        return StepResult(position, after, start.multiplier + reactions, *solution)

    def _impulses(
        self, approach: Approach, mobility: Mobility, before: StepResult | None
    ) -> tuple[Impulses, np.ndarray, np.ndarray, CompliantContacts]:
        """Impulses of the contacts, their offsets, which are updated until they no longer change,
        keys of the sticking contacts with static friction, and the compliant contacts."""
        contacts, shape = approach.contacts, approach.before.shape
        soft = self.force_laws, approach
        if not contacts.count:
            empty = Impulses(np.zeros(shape), 0.0, True)
            absent = CompliantContacts(*soft, np.zeros(0), self.scheme.theta)
            return empty, np.zeros(shape), contacts.key[:0], absent
        matrix = delassus(contacts.directions, mobility)
        own = matrix.diagonal().reshape(shape)[:, 0]
        compliant = CompliantContacts(*soft, own, self.scheme.theta)
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
            offsets[compliant.rows, 0] = compliant.offsets
            velocity = free + offsets
            problem = FrictionProblem(matrix, velocity, laws.friction, contacts.groups, scale)
            problem = compliant_problem(problem, compliant.compliance)
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
            pushes = solution.impulses
            if compliant.rows.size:
                after, pushes = (matrix @ start.ravel()).reshape(shape) + free, start.copy()
                pushes[compliant.rows, 0] = 0.0  # force laws may do work
            changed = self.scheme.again(approach, offsets, pushes, after)
            if changed is not None:
                changed[compliant.rows, 0] = offsets[compliant.rows, 0]
                changed = changed if (changed != offsets).any() else None
            size = problem.size(start)
            softened = compliant.update(start[:, 0], after[:, 0], self.solver.tolerance * size)
            if not (softened or changed is not None) or not solution.accepted:
                break
            offsets = offsets if changed is None else changed
        stuck = none
        if laws.higher_at_rest.any():
            stuck = contacts.key[(start[:, 0] > 0) & sticks(self.solver, problem, solution)]
        solution = compliant.solution(replace(solution, rounds=rounds), after, self.solver, size)
        solution = solution if impact is None else in_succession(impact, solution)
        return solution, offsets, stuck, compliant


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
