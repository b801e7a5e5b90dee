"""Impacts with friction by compression and expansion.

Normal impulses grow until the gaps no longer close, then by the law of restitution; friction
follows Coulomb's law all along, ``dP_T = −μ dP_N u_T/|u_T|`` or ``u_T = 0`` (Routh 1860; Darboux
1880; Stronge, Impact Mechanics, 2000, ch. 3-5). Speeds are linear in the impulses as long as the
slip of each contact keeps its direction, so that one increment is exact; ends of slip are located.
Where slips turn in space, increments are divided and follow the midpoint rule.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.impact_slip import Pace, Slip, slip_of
from dalembert.integrators.contact.impulses import Impulses
from dalembert.integrators.contact.static_friction import STILL

Conditions = Callable[[float], tuple[np.ndarray, float | np.ndarray]]
"""Share of an increment → smallest ``u_N`` after it, smallest impulses."""
MAX_INCREMENTS, CORRECTIONS = 2000, 8
"""Upper limits of the increments of a phase, and of the corrections of one."""
LARGEST = 4.0
"""Upper limit of the normal impulse that restores energy, relative to Poisson's law [-]."""
RESTORED = 1e-10
"""Accuracy of the restored energy of a contact, relative to its own in compression, unless the
tolerance of the solver is smaller, and threshold relative to the largest one [-]."""


class Phase(Enum):
    """Phase of an impact."""

    COMPRESSION = "compression"
    EXPANSION = "expansion"
    RESTORATION = "restoration"


@dataclass(frozen=True, eq=False)
class Increment:
    """Impulses with ``u_N ≥ lowest``, ``P_N ≥ minimum``, in which no slip ends.

    Attributes
    ----------
    phase : of the impact
    span : completed shares of the phase at its start and end; in the restoration of this increment
    centred : whether conditions are those of its middle, with half of the impulses
    lowest, minimum : (n,) conditions
    impulses, before, after : (n, k) impulses, and velocities around them
    ended : (n, groups) mask of the slips that end or turn back
    """

    phase: Phase
    span: tuple[float, float]
    centred: bool
    lowest: np.ndarray
    minimum: np.ndarray
    impulses: np.ndarray
    before: np.ndarray
    after: np.ndarray
    ended: np.ndarray


class ImpactPath:
    """Course of an impact.

    Parameters
    ----------
    problem : with the velocities before the impact
    solver : of the increments

    Attributes
    ----------
    impulses : (n, k) sums of the increments
    velocity : (n, k) after the increments
    work : (n,) energy taken up by the normal impulses [J]
    converged, accepted : whether all increments are, and the phases ended
    residual, rounds : largest residual, and iterations, of the increments
    rounding : slip that counts as zero [m/s]
    lowest : (n,) normal speeds that increments of the restored energy do not fall below
    increments : of all phases
    """

    def __init__(self, problem: FrictionProblem, solver: ContactSolver):
        self.problem, self.solver = problem, solver
        self.velocity, self.impulses = problem.velocity, np.zeros(problem.shape)
        self.work, self.residual, self.rounds = np.zeros(problem.shape[0]), 0.0, 0
        self.converged = self.accepted = True
        self.lowest = np.zeros(problem.shape[0])
        self.rounding = STILL * solver.newton_tolerance * problem.scale
        self.increments: list[Increment] = []

    def compress(self) -> None:
        """Increments until no gap closes; closing speeds decrease in proportion."""
        closing = np.minimum(self.velocity[:, 0], 0.0)
        self._march(Phase.COMPRESSION, lambda done, share: ((1 - done - share) * closing, 0.0))

    def expand(self, normal: np.ndarray, speed: np.ndarray) -> None:
        """Increments whose normal impulses are (n,) ``normal`` or, to reach the normal speeds (n,)
        ``speed``, larger."""
        self._march(Phase.EXPANSION, lambda done, share: ((done + share) * speed, share * normal))
        self.lowest = speed

    def restore(self, energy: np.ndarray, normal: np.ndarray) -> None:
        """Increments whose normal impulses do the work (n,) ``energy``, or less.

        ``normal`` (n,) are estimates of the impulses, of which they do not exceed a multiple.
        """
        target, pace, whole, corrections = self.work - energy, Pace(), normal, 0
        accuracy = min(RESTORED, self.solver.newton_tolerance)
        limit = np.maximum(accuracy * energy, RESTORED**2 * energy.max(initial=0.0))
        most = self.impulses[:, 0] + LARGEST * normal
        for _ in range(MAX_INCREMENTS):
            left, allowed = self.work - target, most - self.impulses[:, 0]
            running = (left > limit) & (allowed > RESTORED * most)
            if not running.any() or not self.accepted:
                break
            increments = np.where(running, pace.share * whole, 0.0)
            increment = self._increment(
                Phase.RESTORATION,
                (0.0, pace.share),
                lambda part, least=increments: (self.lowest, part * least),  # type: ignore[misc]
            )
            slip = self._slip(increment)
            if pace.is_too_long(slip):
                continue
            part = np.minimum(self._part(increment, left), allowed) / pace.share
            wrong = running & (part < whole * (1 - accuracy))
            if pace.share == 1 and corrections < CORRECTIONS:
                wrong |= running & (part > whole * (1 + accuracy))
            if wrong.any():
                whole = np.where(wrong, part, whole)
                corrections += 1
                continue
            pace.accept(slip)
            self._accept(increment)
            corrections = 0
        else:
            self.accepted = self.converged = False

    def _march(
        self,
        phase: Phase,
        conditions: Callable[[float, float], tuple[np.ndarray, float | np.ndarray]],
    ) -> None:
        """Increments of a phase, with conditions for its completed share and the next one."""
        done, pace = 0.0, Pace()
        for _ in range(MAX_INCREMENTS):
            if done >= 1 or not self.accepted:
                break
            pace.share = min(pace.share, 1 - done)
            begun, share = done, pace.share
            increment = self._increment(
                phase,
                (begun, begun + share),
                lambda part, begun=begun, share=share: conditions(begun, part * share),  # type: ignore[misc]
            )
            if pace.is_too_long(slip := self._slip(increment)):
                continue
            done += share
            pace.accept(slip)
            self._accept(increment)
        else:
            self.accepted = self.converged = False

    def _increment(
        self, phase: Phase, span: tuple[float, float], conditions: Conditions
    ) -> Increment:
        """Next increment: with the directions of slip at its end or, where they change, in its
        middle, which is of second order."""
        state, (lowest, minimum) = (phase, span), conditions(1.0)
        impulses, after = self._solved(lowest, minimum)
        slip = self._slip_of(impulses, after)
        least = np.broadcast_to(minimum, lowest.shape)
        step = Increment(*state, False, lowest, least, impulses, self.velocity, after, slip.ended)
        if slip.ends or not slip.turns:
            return step
        middle, half = conditions(0.5)
        impulses, between = self._solved(middle, half)
        impulses, after = 2 * impulses, 2 * between - self.velocity
        slip = self._slip_of(impulses, after)
        if slip.ends or (after[:, 0] < lowest - self.rounding).any():
            return step
        return Increment(*state, True, middle, least, impulses, self.velocity, after, slip.ended)

    def _solved(
        self, lowest: np.ndarray, minimum: float | np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Impulses of at least a minimum with ``u_N ≥ lowest``, and velocities after them."""
        velocity = self.velocity.copy()
        velocity[:, 0] -= lowest
        problem = replace(self.problem, velocity=velocity, minimum=minimum)
        solution = self.solver.solve(problem)
        self.converged &= solution.converged
        self.accepted &= solution.accepted
        self.residual = max(self.residual, solution.residual)
        self.rounds += solution.rounds
        after = problem.speeds(solution.impulses)
        after[:, 0] += lowest
        return solution.impulses, after

    def _accept(self, step: Increment) -> None:
        self.increments.append(step)
        work = step.impulses[:, 0] * (step.before[:, 0] + step.after[:, 0]) / 2
        self.work, self.velocity = self.work - work, step.after
        self.impulses = self.impulses + step.impulses

    def _slip(self, step: Increment) -> Slip:
        return self._slip_of(step.impulses, step.after)

    def _slip_of(self, impulses: np.ndarray, after: np.ndarray) -> Slip:
        return slip_of(self.problem, self.velocity, impulses, after, self.rounding)

    def _part(self, step: Increment, energy: np.ndarray) -> np.ndarray:
        """(n,) normal impulses that do the work ``energy``, for linear speeds."""
        start, push = np.maximum(self.velocity[:, 0], 0.0), step.impulses[:, 0]
        with np.errstate(all="ignore"):
            slope = (step.after[:, 0] - start) / push
            root = np.sqrt(np.maximum(start**2 + 2 * slope * energy, 0.0))
            part = 2 * energy / (start + root)
        return np.where(np.isfinite(part), part, push)


def impact_impulses(
    problem: FrictionProblem, laws: ContactLaws, solver: ContactSolver
) -> tuple[Impulses, list[Increment]]:
    """Impulses of an impact with compression and expansion, and their increments.

    Contacts of all laws are compressed together. Then those of Poisson's law expand by their
    impulses while those of Newton's law reach their speeds, then the energetic law restores energy.

    Parameters
    ----------
    problem : with the velocities before the impact
    laws : restitution, and the law of each contact
    solver : of the increments
    """
    path, e = ImpactPath(problem, solver), laws.restitution
    newton, poisson, energetic = (laws.follows(law) for law in ImpactLaw)
    speed = np.where(newton, -e * np.minimum(problem.velocity[:, 0], 0.0), 0.0)
    path.compress()
    pressed, work = e * path.impulses[:, 0], path.work
    if newton.any() or poisson.any():
        path.expand(np.where(poisson, pressed, 0.0), speed)
    if energetic.any():
        path.restore(np.where(energetic, e**2 * work, 0.0), np.where(energetic, pressed, 0.0))
    outcome = path.residual, path.converged, path.rounds, path.accepted
    return Impulses(path.impulses, *outcome), path.increments
