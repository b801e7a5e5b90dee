"""One time step with contacts: velocities, impulses, positions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.gaps import FormulaGaps, GapSource
from dalembert.analysis.nonsmooth.mobility import Mobility
from dalembert.analysis.nonsmooth.smooth_motion import SmoothMotion
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
AHEAD, WIDER, WIDENINGS = 2.0, 4.0, 4
"""Search distance for gaps in motions of a step; its growth, and number of enlargements, where a
body penetrated another one from beyond this distance."""
CLOSED = 1e-12
"""Penetration that counts as rounding, by the natural length."""
APART = 2**54
"""Offset between the keys of gaps of different sources."""


@dataclass(frozen=True, eq=False)
class StepResult:
    """Result of one step.

    Attributes
    ----------
    y, v : state at the end
    multiplier : of the joints, times the step
    contacts : contacts of the friction problem
    impulses : solution of the friction problem
    offsets : (n, k) velocity offsets of the conditions
    stuck : keys of the contacts with static friction at the end
    loss : energy dissipated by the contacts
    """

    y: np.ndarray
    v: np.ndarray
    multiplier: np.ndarray
    contacts: Contacts
    impulses: Impulses
    offsets: np.ndarray
    stuck: np.ndarray
    loss: float

    @property
    def pressing(self) -> tuple[np.ndarray, np.ndarray]:
        """Sorted keys, and impulses, of the contacts that press."""
        rows = np.flatnonzero(self.impulses.impulses[:, 0] > 0)
        rows = rows[np.argsort(self.contacts.key[rows])]
        return self.contacts.key[rows], self.impulses.impulses[rows]


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
        theta, go = self.scheme.theta, self.model.equations.manifold.go
        free, multiplier, mobility = self.smooth.step(t, y, v, self.p, h, theta)
        reach, begins = AHEAD * h, before is None
        for _ in range(WIDENINGS):
            contacts = self.near(t, y, reach * np.column_stack([v, free]))
            approach = Approach(
                contacts, contacts.speeds(v), contacts.speeds(free), h, begins, self.rounding
            )
            acting = self.scheme.acting(approach)
            if not acting.all():
                contacts = contacts.some(acting)
                speeds = {"before": approach.before[acting], "free": approach.free[acting]}
                approach = replace(approach, contacts=contacts, **speeds)
            impulses, offsets, stuck = self._impulses(approach, mobility, before)
            push = impulses.impulses.ravel()
            change, reactions = mobility(contacts.directions.T @ push)
            after = free + change
            position = go(y, h * (theta * after + (1 - theta) * v))
            if not self.scheme.anticipates or not np.isfinite(position).all():
                break
            if self.deepest(t + h, position) >= -self.rounding:
                break
            if np.isin(self.closed(t + h, position).key, contacts.key).all():
                break
            reach *= WIDER
        loss = -0.5 * float(push @ (contacts.directions @ (after + v)))
        reactions += multiplier
        return StepResult(position, after, reactions, contacts, impulses, offsets, stuck, loss)

    def _impulses(
        self, approach: Approach, mobility: Mobility, before: StepResult | None
    ) -> tuple[Impulses, np.ndarray, np.ndarray]:
        """Impulses of the contacts, their offsets, which are updated until they no longer change,
        and keys of the sticking contacts with static friction."""
        contacts, shape = approach.contacts, approach.before.shape
        if not contacts.count:
            return Impulses(np.zeros(shape), 0.0, True), np.zeros(shape), contacts.key[:0]
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
            free, offsets = free + at_end - approach.before, approach.held(at_end)
        for _ in range(ROUNDS):
            velocity = free + offsets
            problem = FrictionProblem(matrix, velocity, laws.friction, contacts.groups, scale)
            solution, static = solve_with_static_friction(
                self.solver, problem, start, laws, static, approach.before
            )
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
        solution = solution if impact is None else in_succession(impact, solution)
        return solution, offsets, stuck


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


def warm_start(contacts: Contacts, before: StepResult | None, shape: tuple[int, ...]) -> np.ndarray:
    """Impulses of the same gaps in the step before; zero for new contacts."""
    start = np.zeros(shape)
    if before is None or not before.pressing[0].size:
        return start
    keys, impulses = before.pressing
    position = np.minimum(np.searchsorted(keys, contacts.key), keys.size - 1)
    same = keys[position] == contacts.key
    start[same] = impulses[position[same]]
    return start
