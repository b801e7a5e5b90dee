"""One step with contacts: velocities, impulses, positions."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dalembert.analysis.nonsmooth.gap_source import GapSource, StatedGap
from dalembert.analysis.nonsmooth.smooth_motion import SmoothMotion, Solve
from dalembert.integrators.contact.contact_solver import ContactSolver, Impulses
from dalembert.integrators.contact.contacts import Contacts
from dalembert.integrators.contact.friction_problem import FrictionProblem
from dalembert.integrators.contact.schemes import Approach, ContactScheme
from dalembert.model.model import Model
from dalembert.symbolic.evaluation.kernel import dense_array

ROUNDS = 50
"""Times that contacts may ask for something else in one step."""
AHEAD, WIDER, WIDENINGS = 2.0, 4.0, 4
"""Motions of a step within which gaps are looked for, and how often much further, where something
came through from outside."""
CLOSED = 1e-12
"""Penetration, by the natural length, that is called rounding."""
APART = 2**40
"""Between the keys of gaps of different sources."""


@dataclass(frozen=True, eq=False)
class StepResult:
    """A step taken.

    Attributes
    ----------
    y, v : at its end
    multiplier : of the joints, times the step
    contacts : those that took part
    impulses : what was found for them
    loss : energy that they took
    """

    y: np.ndarray
    v: np.ndarray
    multiplier: np.ndarray
    contacts: Contacts
    impulses: Impulses
    loss: float

    @property
    def known(self) -> tuple[np.ndarray, np.ndarray]:
        """Keys in order, and impulses, of contacts that press."""
        pressed = np.flatnonzero(self.impulses.impulses[:, 0] > 0)
        pressed = pressed[np.argsort(self.contacts.key[pressed])]
        return self.contacts.key[pressed], self.impulses.impulses[pressed]


@dataclass(frozen=True, eq=False)
class ContactStep:
    """Takes steps of one model.

    Attributes
    ----------
    model : Model
    smooth, sources : its functions
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
        """Gaps of all sources within reach of some displacements."""
        parts, elements = [], 0
        for number, source in enumerate(self.sources):
            found = source.near(t, y, self.p, travels, self.width)
            parts.append(
                replace(found, owner=found.owner + elements, key=found.key + number * APART)
            )
            elements += len(source.elements)
        return Contacts.joined(parts)

    def stated(self, key: int) -> StatedGap:
        """The gap with a key, as formulas."""
        number, own = divmod(int(key), APART)
        return self.sources[number].stated(own)

    def closed(self, t: float, y: np.ndarray) -> Contacts:
        """Gaps that are negative, more than by rounding."""
        found = self.near(t, y, np.zeros((self.model.equations.speed_count, 1)))
        return found.some(found.distance < -CLOSED * self.model.scales.length)

    def take(
        self, t: float, h: float, y: np.ndarray, v: np.ndarray, before: StepResult | None
    ) -> StepResult:
        """A step of length ``h`` after another one, whose impulses are near."""
        theta, go = self.scheme.theta, self.model.equations.manifold.go
        free, multiplier, solve = self.smooth.step(t, y, v, self.p, h, theta)
        ahead, begins = AHEAD * h, before is None
        for _ in range(WIDENINGS):
            contacts = self.near(t, y, ahead * np.column_stack([v, free]))
            approach = Approach(contacts, contacts.speeds(v), contacts.speeds(free), h, begins)
            acting = self.scheme.acting(approach)
            if not acting.all():
                contacts = contacts.some(acting)
                speeds = approach.before[acting], approach.free[acting]
                approach = Approach(contacts, *speeds, h, begins)
            mobility, joints = self._mobility(contacts, solve)
            found = self._impulses(approach, mobility, before)
            push = found.impulses.ravel()
            after = free + mobility @ push
            place = go(y, h * (theta * after + (1 - theta) * v))
            if not self.scheme.anticipates or not np.isfinite(place).all():
                break
            if np.isin(self.closed(t + h, place).key, contacts.key).all():
                break
            ahead *= WIDER
        lost = -0.5 * float(push @ (contacts.directions @ (after + v)))
        return StepResult(place, after, multiplier + joints @ push, contacts, found, lost)

    def _mobility(self, contacts: Contacts, solve: Solve) -> tuple[np.ndarray, np.ndarray]:
        """Changes of speeds and of multipliers by impulses."""
        directions = dense_array(contacts.directions).T
        return solve(directions, None)

    def _impulses(
        self, approach: Approach, mobility: np.ndarray, before: StepResult | None
    ) -> Impulses:
        """Impulses of the contacts, once they have settled on what they ask for."""
        contacts, shape = approach.contacts, approach.before.shape
        if not contacts.count:
            return Impulses(np.zeros(shape), 0.0, True)
        matrix = contacts.directions @ mobility
        offsets = self.scheme.first(approach)
        scale = float(max(np.abs(approach.free).max(), np.abs(approach.before).max()))
        start, rounds = remembered(contacts, before, shape), 0
        for _ in range(ROUNDS):
            problem = FrictionProblem(
                matrix, approach.free + offsets, contacts.friction, scale or 1.0
            )
            found = self.solver.solve(problem, start)
            start, rounds = found.impulses, rounds + found.rounds
            after = problem.speeds(found.impulses) - offsets
            changed = self.scheme.again(approach, offsets, found.impulses, after)
            if changed is None or not found.converged:
                break
            offsets = changed
        return replace(found, rounds=rounds)


def remembered(contacts: Contacts, before: StepResult | None, shape: tuple[int, ...]) -> np.ndarray:
    """Impulses of the same gaps in the step before, zero where there are none."""
    start = np.zeros(shape)
    if before is None or not before.known[0].size:
        return start
    keys, impulses = before.known
    place = np.minimum(np.searchsorted(keys, contacts.key), keys.size - 1)
    same = keys[place] == contacts.key
    start[same] = impulses[place[same]]
    return start
