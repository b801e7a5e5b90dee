"""One time step with contacts: velocities, impulses, positions."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.gaps import GapSource, Instant, SymbolicGap
from dalembert.analysis.nonsmooth.joined_gaps import selected_of, separating_of
from dalembert.analysis.nonsmooth.mean_gaps import mean_gaps
from dalembert.analysis.nonsmooth.mobility import Mobility
from dalembert.analysis.nonsmooth.smooth_motion import SmoothMotion
from dalembert.analysis.nonsmooth.step_state import StepResult, StepStart, warm_start
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.contacts import Contacts, FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.integrators.contact.impulses import Impulses
from dalembert.integrators.contact.schemes import Approach, ContactScheme
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
APART = 2**40
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

    @property
    def width(self) -> int:
        """Components of the relative velocities."""
        return max((source.width for source in self.sources), default=1)

    def near(self, t: float, y: np.ndarray, travels: np.ndarray) -> Contacts:
        """Gaps of all sources within reach of the displacements ``travels``."""
        parts, elements = [], 0
        for number, source in enumerate(self.sources):
            contacts = source.near(t, y, self.p, travels, self.width)
            parts.append(
                replace(
                    contacts, owner=contacts.owner + elements, key=contacts.key + number * APART
                )
            )
            elements += len(source.elements)
        return Contacts.joined(parts)

    def selected(self, t: float, y: np.ndarray, keys: np.ndarray) -> Contacts:
        """Gaps with some keys, at any distance."""
        gaps = selected_of(self.sources, APART, t, y, self.p, keys, self.width)
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
        acting = self.scheme.acting(start.approach(contacts))
        return self._closed(start, contacts.some(acting), before)

    def _solved(
        self, start: StepStart, contacts: Contacts, before: StepResult | None
    ) -> StepResult:
        """Solution for some contacts."""
        v, theta = start.v, self.scheme.theta
        impulses = self._impulses(start.approach(contacts), start.mobility, before)
        push = impulses.impulses.ravel()
        change, reactions = start.mobility(contacts.directions.T @ push)
        after = start.free + change
        displacement = start.h * (theta * after + (1 - theta) * v)
        position = self.model.equations.manifold.go(start.y, displacement)
        loss = -0.5 * float(push @ (contacts.directions @ (after + v)))
        multiplier = start.multiplier + reactions
        return StepResult(position, after, multiplier, contacts, impulses, loss)

    def _closed(
        self, start: StepStart, contacts: Contacts, before: StepResult | None
    ) -> StepResult:
        """Solution in which the gaps that a correction would open have their impact, too."""
        result, end = self._solved(start, contacts, before), start.t + start.h
        for _ in range(REPETITIONS if self.scheme.projection else 0):
            if not np.isfinite(result.y).all() or self.deepest(end, result.y) >= -self.rounding:
                break
            keys = self.closed(end, result.y).key
            keys = keys[~np.isin(keys, contacts.key)]
            if not keys.size:
                break
            contacts = Contacts.joined([contacts, self.selected(start.t, start.y, keys)])
            again = self._solved(start, contacts, result)
            push = again.impulses.impulses.ravel()
            exchanged = float(push @ (again.contacts.directions @ (again.v - start.free)))
            gains = again.loss < min(result.loss, -GAIN * exchanged)
            if gains or not again.impulses.converged:
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
            if not again.impulses.converged:
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
            approach = start.approach(Contacts.joined([contacts, gaps]))
            forced = np.abs(approach.free - approach.before).max(initial=0.0)
            closed &= gaps.distance < -start.h * forced / 2
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
    ) -> Impulses:
        """Impulses of the contacts; offsets are updated until they no longer change."""
        contacts, shape = approach.contacts, approach.before.shape
        if not contacts.count:
            return Impulses(np.zeros(shape), 0.0, True)
        matrix = delassus(contacts.directions, mobility)
        offsets = self.scheme.first(approach)
        scale = float(max(np.abs(approach.free).max(), np.abs(approach.before).max()))
        groups = (shape[1] - 1,) if shape[1] > 1 else ()
        friction = contacts.friction[:, None][:, : len(groups)]
        start, rounds = warm_start(contacts, before, shape), 0
        for _ in range(ROUNDS):
            velocity = approach.free + offsets
            problem = FrictionProblem(matrix, velocity, friction, groups, scale or 1.0)
            solution = self.solver.solve(problem, start)
            if solution.residual > JAMMED * (scale or 1.0):
                solution = self.solver.solve(problem)
                accurate = solution.residual <= JAMMED * (scale or 1.0)
                solution = replace(solution, converged=solution.converged and accurate)
            start, rounds = solution.impulses, rounds + solution.rounds
            after = problem.speeds(solution.impulses) - offsets
            changed = self.scheme.again(approach, offsets, solution.impulses, after)
            if changed is None or not solution.converged:
                break
            offsets = changed
        return replace(solution, rounds=rounds)


def delassus(directions: Matrix, mobility: Mobility) -> np.ndarray | Delassus:
    """``W A⁻¹ Wᵀ``, as an operator if the directions are sparse."""
    responses = mobility.responses(directions)
    if not scipy.sparse.issparse(directions):
        return np.asarray(directions @ responses.T)
    none = np.zeros(directions.shape[0])
    return Delassus(directions, responses, mobility.matrix, mobility.joints, none)
