"""Impacts with friction by compression and expansion.

Normal impulses grow until the gaps no longer close, then by the law of restitution; friction
follows Coulomb's law all along, ``dP_T = −μ dP_N u_T/|u_T|`` or ``u_T = 0`` (Routh 1860; Darboux
1880; Stronge, Impact Mechanics, 2000, ch. 3-5). Speeds are linear in the impulses as long as the
slip of each contact keeps its direction, so that one increment is exact; ends of slip are located.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.impact_slip import Pace, Slip, slip_of
from dalembert.integrators.contact.impulses import Impulses
from dalembert.integrators.contact.static_friction import STILL

Conditions = Callable[[float, float], tuple[np.ndarray, float | np.ndarray]]
"""Completed share of a phase and the next share → smallest ``u_N``, smallest impulses."""
Step = tuple[np.ndarray, np.ndarray]
"""(n, k) impulses of an increment, and velocities after it."""
MAX_INCREMENTS, CORRECTIONS = 2000, 8
"""Upper limits of the increments of a phase, and of the corrections of one."""
LARGEST = 4.0
"""Upper limit of the normal impulse that restores energy, relative to Poisson's law [-]."""
RESTORED = 1e-10
"""Accuracy of the restored energy of a contact, relative to its own in compression, and threshold
relative to the largest one [-]."""


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
    """

    def __init__(self, problem: FrictionProblem, solver: ContactSolver):
        self.problem, self.solver = problem, solver
        self.velocity, self.impulses = problem.velocity, np.zeros(problem.shape)
        self.work, self.residual, self.rounds = np.zeros(problem.shape[0]), 0.0, 0
        self.converged = self.accepted = True
        self.lowest = np.zeros(problem.shape[0])
        self.rounding = STILL * solver.tolerance * problem.scale

    def compress(self) -> None:
        """Increments until no gap closes; closing speeds decrease in proportion."""
        closing = np.minimum(self.velocity[:, 0], 0.0)
        self._march(lambda done, share: ((1 - done - share) * closing, 0.0))

    def expand(self, normal: np.ndarray, speed: np.ndarray) -> None:
        """Increments whose normal impulses are (n,) ``normal`` or, to reach the normal speeds (n,)
        ``speed``, larger."""
        self._march(lambda done, share: ((done + share) * speed, share * normal))
        self.lowest = speed

    def restore(self, energy: np.ndarray, normal: np.ndarray) -> None:
        """Increments whose normal impulses do the work (n,) ``energy``, or less.

        ``normal`` (n,) are estimates of the impulses, of which they do not exceed a multiple.
        """
        target, pace, whole, corrections = self.work - energy, Pace(), normal, 0
        limit = RESTORED * np.maximum(energy, RESTORED * energy.max(initial=0.0))
        most = self.impulses[:, 0] + LARGEST * normal
        for _ in range(MAX_INCREMENTS):
            left, allowed = self.work - target, most - self.impulses[:, 0]
            running = (left > limit) & (allowed > RESTORED * most)
            if not running.any() or not self.accepted:
                break
            increments = np.where(running, pace.share * whole, 0.0)
            step = self._increment(self.lowest, increments)
            if pace.is_too_long(self._slip(step)):
                continue
            part = np.minimum(self._part(step, left), allowed) / pace.share
            wrong = running & (part < whole * (1 - RESTORED))
            if pace.share == 1 and corrections < CORRECTIONS:
                wrong |= running & (part > whole * (1 + RESTORED))
            if wrong.any():
                whole = np.where(wrong, part, whole)
                corrections += 1
                continue
            pace.accept(self._slip(step))
            self._accept(step)
            corrections = 0
        else:
            self.accepted = self.converged = False

    def _march(self, conditions: Conditions) -> None:
        """Increments of a phase."""
        done, pace = 0.0, Pace()
        for _ in range(MAX_INCREMENTS):
            if done >= 1 or not self.accepted:
                break
            pace.share = min(pace.share, 1 - done)
            step = self._increment(*conditions(done, pace.share))
            if pace.is_too_long(slip := self._slip(step)):
                continue
            done += pace.share
            pace.accept(slip)
            self._accept(step)
        else:
            self.accepted = self.converged = False

    def _increment(self, lowest: np.ndarray, minimum: float | np.ndarray) -> Step:
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

    def _accept(self, step: Step) -> None:
        impulses, after = step
        self.work = self.work - self._work(step)
        self.impulses, self.velocity = self.impulses + impulses, after

    def _slip(self, step: Step) -> Slip:
        return slip_of(self.problem, self.velocity, *step, self.rounding)

    def _work(self, step: Step) -> np.ndarray:
        """(n,) work of the normal impulses of an increment on the bodies."""
        impulses, after = step
        work: np.ndarray = impulses[:, 0] * (self.velocity[:, 0] + after[:, 0]) / 2
        return work

    def _part(self, step: Step, energy: np.ndarray) -> np.ndarray:
        """(n,) normal impulses that do the work ``energy``, for linear speeds."""
        start, push = np.maximum(self.velocity[:, 0], 0.0), step[0][:, 0]
        with np.errstate(all="ignore"):
            slope = (step[1][:, 0] - start) / push
            root = np.sqrt(np.maximum(start**2 + 2 * slope * energy, 0.0))
            part = 2 * energy / (start + root)
        return np.where(np.isfinite(part), part, push)


def impact_impulses(
    problem: FrictionProblem, laws: ContactLaws, solver: ContactSolver
) -> tuple[Impulses, np.ndarray]:
    """Impulses of an impact with compression and expansion, and (n, k) velocities after it.

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
    return Impulses(path.impulses, *outcome), path.velocity
