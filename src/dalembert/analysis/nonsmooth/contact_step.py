"""Solution of one time step with some contacts: velocities, impulses, positions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dalembert.analysis.nonsmooth.blocked_contacts import without_unresolved
from dalembert.analysis.nonsmooth.compliant_contacts import CompliantContacts
from dalembert.analysis.nonsmooth.force_laws import ForceLaws
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.model_gaps import ModelGaps
from dalembert.analysis.nonsmooth.gyroscopic import turn_error
from dalembert.analysis.nonsmooth.impact_stage import impact_stage
from dalembert.analysis.nonsmooth.middle_directions import (
    in_middle,
    is_same_side,
    with_clearance,
)
from dalembert.analysis.nonsmooth.mobility import delassus
from dalembert.analysis.nonsmooth.smooth_motion import FreeMotion, SmoothMotion
from dalembert.analysis.nonsmooth.step_state import (
    LastImpulses,
    StepResult,
    StepStart,
    convergence_rate,
    warm_start,
)
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.approach import Approach
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.contacts import Contacts, FrictionProblem
from dalembert.integrators.contact.impulses import Impulses, compliant_problem
from dalembert.integrators.contact.mean_slip import MeanSlip
from dalembert.integrators.contact.schemes import ContactScheme
from dalembert.integrators.contact.static_friction import (
    STILL,
    may_stick,
    solve_precisely,
    solve_with_static_friction,
    sticks,
)

ROUNDS = 50
"""Upper limit of the changes of the contact offsets in one step."""
JAMMED = 1e-6
"""Upper limit of the residual relative to the speeds before the impulses, which may be large
without any effect where contacts jam [-]."""
PATHS = 20
"""Upper limit of the repetitions of a step with means over its path."""
GROWTHS = 2
"""Upper limit of the repetitions that change the speeds more than the one before."""
SAME_MEANS = 1e-14
"""Estimated error of the means over a step, as that by which joints are open at its end [-]."""
TRAVEL = 1e-6
"""Part of a gap closed in a step that counts as an impact, by the size of the bodies [-]."""
CLEARANCE = 2e-7
"""Clearance of gaps whose directions turn, by the size of the bodies [-]."""


@dataclass(frozen=True, eq=False)
class ContactStep(ModelGaps):
    """Time steps of one model.

    Attributes
    ----------
    smooth : functions of the model
    scheme, solver : strategies
    longest : longest step; those that do not converge are divided [s]
    rest : as in ``Approach`` [s]
    """

    smooth: SmoothMotion
    scheme: ContactScheme
    solver: ContactSolver
    longest: float
    rest: float = 0.0

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
        all_laws = [law for source in self.sources for law in source.impact_laws()]
        impacts = [(element.name, law) for element, law in all_laws if law is not ImpactLaw.NEWTON]
        if laws.elements and impacts:
            name, law = impacts[0]
            raise UnsupportedError(
                f"{name} has the {law.value} law of impact and {laws.elements[0].name} a force "
                f"law, which are not available in one model; leave out one of them"
            )
        return laws

    def begin(self, t: float, h: float, y: np.ndarray, v: np.ndarray, first: bool) -> StepStart:
        """Start of a step, ``first`` of a run or not."""
        smooth = self.smooth.step(t, y, v, self.p, h, self.scheme.theta)
        return StepStart(smooth, smooth.free, self.longest, first, rest=self.rest)

    def in_middle(self, start: StepStart, contacts: Contacts, lasting: bool = False) -> Contacts:
        """Gaps at the start of a step with the directions in its middle, except those of impacts,
        which ``lasting`` contacts do not have."""
        lead, v = (1 - self.scheme.theta) * start.h, start.v
        if not (contacts.count and lead):
            return contacts
        manifold = self.model.equations.manifold
        at = self.at(start.t + lead, manifold.go(start.y, manifold.halfway(2 * lead * v)))
        middle = self.following(at, contacts.key, self.at(start.t, start.y))
        kept, free = np.zeros(middle.count, dtype=bool), start.smooth.free.speeds
        if not lasting:
            speeds = contacts.speeds(v), contacts.speeds(free)
            approach = Approach(contacts, *speeds, start.h, self.longest, rest=self.rest)
            kept = approach.impacting & (-start.h * approach.before[:, 0] > self.least_travel)
            ends = contacts.distance + start.h * middle.speeds((v + free) / 2)[:, 0]
            same_side = is_same_side(contacts, middle, self.model.scales.displacements)
            kept &= ~((middle.distance >= 0) & (ends >= 0) & same_side)
        moved = in_middle(contacts, middle, kept, v)
        if not self.scheme.anticipates:
            return moved
        rigid = ~self.force_laws.compliant(contacts)
        distance = self.cleared(moved.distance, rigid[:, None] * moved.turning, start.h)
        return replace(moved, distance=distance)

    def cleared(
        self, distance: np.ndarray, turning: np.ndarray, h: float | np.ndarray
    ) -> np.ndarray:
        """(n,) distances in the conditions of gaps, for ``turning`` (n, k) of ``Contacts``."""
        if not self.scheme.anticipates:
            return distance
        return with_clearance(distance, h * turning[:, 0], self.rounding, self.clearance)

    def starting(self, start: StepStart, keys: np.ndarray) -> Contacts:
        """Gaps with some keys in a step from ``start``."""
        return self.in_middle(start, self.selected(self.at(start.t, start.y), keys))

    def deepest(self, configuration: Configuration) -> float:
        """The smallest gap of rigid contacts if it is negative, else 0 [m]."""
        if self.force_laws.elements:
            gaps = self.touching(configuration)
            rigid = ~self.force_laws.compliant(gaps)
            return float(gaps.distance[rigid].min(initial=0.0))
        return min(source.deepest(configuration) for source in self.sources)

    def closed(self, configuration: Configuration) -> Contacts:
        """Gaps of rigid contacts that are negative by more than rounding."""
        contacts = self.touching(configuration)
        rigid = ~self.force_laws.compliant(contacts)
        return contacts.some(rigid & (contacts.distance < -self.rounding))

    def rigid(self, contacts: Contacts) -> Contacts:
        """Those of the contacts that have no force law."""
        compliant = self.force_laws.compliant(contacts)
        return contacts.some(~compliant) if compliant.any() else contacts

    @property
    def least_travel(self) -> float:
        """Part of a gap closed in a step that counts as an impact [m]."""
        return TRAVEL * self.model.scales.size

    @property
    def clearance(self) -> float:
        """Clearance of gaps whose directions turn [m]."""
        return CLEARANCE * self.model.scales.size

    def struck(self, start: StepStart, contacts: Contacts) -> StepStart:
        """The start with the impacts of some contacts by other laws than Newton's, if any."""
        if contacts.laws.follows(ImpactLaw.NEWTON).all():
            return start
        approach = start.approach(contacts, self.rounding)
        stage = impact_stage(approach, start.motion.mobility, self.solver)
        return start if stage is None else start.after(stage)

    def solved(
        self,
        start: StepStart,
        contacts: Contacts,
        before: LastImpulses | None,
        after: np.ndarray | None = None,
    ) -> StepResult:
        """A step with some contacts; impulses of the step ``before`` are the starting point, and
        so are the speeds ``after`` at the end of a similar step for means over its path.

        Means over the step, of its path or of gyroscopic forces, are those of its own solution, by
        repetition; where this does not converge, those of the solution that changes least; a run
        divides such steps.
        """
        smooth, theta = self.smooth, self.scheme.theta
        approach = start.approach(contacts, self.rounding)
        if not (smooth.takes_means(theta) or smooth.turning.size):
            return self._solved(start, start.motion, approach, before)
        if after is None or not smooth.takes_means(theta):
            pressed = before is not None and before.pressing[0].size > 0
            guess = start.v if pressed else start.free
            after = smooth.first_guess(start.smooth, theta, guess)
        last, warm, best, growths, least = np.inf, before, None, 0, np.inf
        stuck = contacts.key[:0] if before is None else before.stuck
        for _ in range(PATHS):
            motion = start.with_impact(smooth.repeated(start.smooth, theta, after))
            result = self._solved(start, motion, approach, warm)
            if not result.impulses.accepted:
                break
            error = self._error_of_means(start, result.v, after)
            if error * convergence_rate(error, last) <= SAME_MEANS:
                return result
            growths += not error < last
            if growths > GROWTHS:
                break
            if error < least:
                least, best = error, result
            after, last = result.v, error
            warm = replace(result.last, stuck=stuck)
        best = best or self._solved(start, start.motion, approach, before)
        return replace(best, path_change=least)

    def _error_of_means(self, start: StepStart, speeds: np.ndarray, assumed: np.ndarray) -> float:
        """Estimated error of the means of a step with other speeds at its end [-]."""
        size, rows = self.model.scales.displacements / start.h, self.smooth.turning
        if not self.smooth.takes_means(self.scheme.theta):
            ends = [start.v + self.scheme.theta * (v - start.v) for v in (speeds, assumed)]
            return turn_error(ends[0][rows], ends[1][rows], size[rows])
        largest = np.abs(np.array([start.v, speeds, assumed]) / size).max(initial=0.0)
        return float(np.abs((speeds - assumed) / size).max(initial=0.0) * largest)

    def _solved(
        self,
        start: StepStart,
        motion: FreeMotion,
        approach: Approach,
        before: LastImpulses | None,
    ) -> StepResult:
        """A step with some contacts and the motion that it has without their impulses."""
        v, theta, contacts = start.v, self.scheme.theta, approach.contacts
        impulses, offsets, stuck, compliant = self._impulses(approach, motion, before)
        impulses = without_unresolved(impulses, contacts, motion.mobility, approach.fastest)
        momentum = contacts.directions.T @ impulses.impulses.ravel()
        change, reactions = motion.mobility(momentum)
        after = motion.speeds + change
        displacement = start.h * (theta * after + (1 - theta) * v)
        position = self.model.equations.manifold.go(start.y, displacement)
        position = start.smooth.states.added(position, after - v)
        mean = 0.5 * (contacts.directions @ (after + v)).reshape(offsets.shape)
        ends = contacts.at_end(after)[:, 0]
        work = np.zeros(contacts.count)
        work[compliant.rows] = (impulses.impulses * mean)[compliant.rows, 0]
        if start.impact is not None:
            momentum = momentum + start.impact.momentum
            impulses = start.impact.added(contacts, impulses)
        loss = -0.5 * float(momentum @ (after + v)) - compliant.stored(ends)
        solution = contacts, impulses, offsets, stuck, loss, work, compliant.fractions(ends)
        multiplier = motion.multiplier + reactions
        solved = position, after, multiplier, *solution, start.longest
        return StepResult(*solved, impact=start.impact)

    def _impulses(
        self, approach: Approach, motion: FreeMotion, before: LastImpulses | None
    ) -> tuple[Impulses, np.ndarray, np.ndarray, CompliantContacts]:
        """Impulses of the contacts, their offsets, which are updated until they no longer change,
        keys of the sticking contacts with static friction, and the compliant contacts."""
        contacts, shape = approach.contacts, approach.before.shape
        soft = self.force_laws, approach
        if not contacts.count:
            empty = Impulses(np.zeros(shape), 0.0, True)
            absent = CompliantContacts(*soft, np.zeros(0), self.scheme.theta)
            return empty, np.zeros(shape), contacts.key[:0], absent
        matrix = delassus(contacts.directions, motion.mobility)
        free, own = contacts.at_end(motion.speeds), np.zeros(contacts.count)
        if self.force_laws.elements:
            own = matrix.diagonal().reshape(shape)[:, 0]
        compliant = CompliantContacts(*soft, own, self.scheme.theta)
        slip, solver = MeanSlip(approach, self.scheme.theta), self.solver
        offsets = slip.first(self.scheme.first(approach))
        laws, none, rounds = contacts.laws, contacts.key[:0], 0
        scale = approach.fastest or 1.0
        rounding = STILL * solver.newton_tolerance * scale
        static = may_stick(contacts, approach.before, before.stuck if before else none, rounding)
        start = warm_start(contacts, before, shape)
        rigid = FrictionProblem(matrix, free, laws.friction, contacts.groups, scale)
        for _ in range(ROUNDS):
            offsets[compliant.rows, 0] = compliant.offsets
            problem = rigid.with_velocity(free + offsets)
            if compliant.rows.size:
                problem = compliant_problem(problem, compliant.compliance)
            state = laws, static, approach.before
            solution, static = solve_with_static_friction(solver, problem, start, *state)
            if solution.converged and solution.residual > JAMMED * scale:
                limit = JAMMED * scale
                solution, static = solve_precisely(solver, problem, solution, limit, *state)
            start, rounds = solution.impulses, rounds + solution.rounds
            after = problem.speeds(solution.impulses) - offsets
            pushes = solution.impulses
            if compliant.rows.size:
                after = (matrix @ start.ravel()).reshape(shape) + free
                pushes = start.copy()
                pushes[compliant.rows, 0] = 0.0  # force laws may do work
            changed = self.scheme.again(approach, offsets, pushes, after)
            changed = slip.again(changed, after)
            changed[compliant.rows, 0] = offsets[compliant.rows, 0]
            size = problem.size(start) if compliant.rows.size else scale
            softened = compliant.update(start[:, 0], after[:, 0], solver.newton_tolerance * size)
            same = not softened and np.array_equal(changed, offsets)
            if same or not solution.accepted:
                break
            offsets = changed
        stuck = none
        if laws.higher_at_rest.any():
            stuck = contacts.key[(start[:, 0] > 0) & sticks(solver, problem, solution)]
        solution = compliant.solution(replace(solution, rounds=rounds), after, solver, size)
        return solution, offsets, stuck, compliant
