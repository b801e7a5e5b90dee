"""Time loop of steps in machine code: state, functions of the step, and transfer of its record."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

import numpy as np

from dalembert.analysis.nonsmooth.active_contacts import NO_PATH, StepPath
from dalembert.analysis.nonsmooth.contact_step import PATHS, SAME_MEANS, ContactStep
from dalembert.analysis.nonsmooth.free_bodies.free_body_motion import FreeBodyMotion
from dalembert.analysis.nonsmooth.free_bodies.free_body_steps import CHUNK, FreeBodySteps
from dalembert.analysis.nonsmooth.free_bodies.sleeping_bodies import SleepingBodies
from dalembert.analysis.nonsmooth.gyroscopic import turn_error
from dalembert.analysis.nonsmooth.step_log import StepLog
from dalembert.analysis.nonsmooth.step_state import (
    PATH_CHANGE,
    LastImpulses,
    convergence_rate,
    step_lengths,
)
from dalembert.integrators.contact.places import Counts
from dalembert.integrators.contact.step_calls import StepOutcome
from dalembert.integrators.contact.step_places import RecordColumns
from dalembert.symbolic.evaluation.fixed_call import FixedCalls

REPORTED = 16
"""Number of steps between reports of the progress."""


class FreeBodyLoop(ABC):
    """Steps of free bodies with balls, hulls and walls; those that machine code cannot do are left
    to the general step.

    Parameters
    ----------
    step : ContactStep
    motion : functions of the step
    steps : arrays and machine code of a step

    Attributes
    ----------
    sleeping : SleepingBodies; None if the scheme has none
    """

    sleeping: SleepingBodies | None = None

    def __init__(self, step: ContactStep, motion: FreeBodyMotion, steps: FreeBodySteps):
        self._step, self._motion = step, motion
        self._t, self._h = np.zeros(1), np.zeros(1)
        self._y = np.zeros(step.model.equations.coordinate_count)
        self._next, self._still = np.zeros_like(self._y), np.zeros_like(steps.v)
        self._ys, self._vs = np.zeros((CHUNK, self._y.size)), np.zeros((CHUNK, steps.v.size))
        self._places, t, v, p = FixedCalls(motion.places, compiled=False), self._t, steps.v, step.p
        self._geometry = steps.corners, steps.references, steps.normals, steps.velocities
        forces = FixedCalls(motion.forces, compiled=False)
        state, mean = [t, self._y, v, p, self._h], np.zeros(step.smooth.turning.size)
        self._forces = forces.on(state, [steps.force, steps.inertia, mean])
        turned = FixedCalls(motion.turned, compiled=False)
        self._turned = turned.on([*state, mean], [steps.force, steps.inertia])
        self._mean = mean
        self._move = self._placed(self._y, steps.displacement, self._next)
        self._place = self._placed(self._y, self._still, self._next)
        ahead = FixedCalls(motion.ahead, compiled=False)
        self._place_ahead = ahead.on(state, [flat(part) for part in steps.ahead])

    @property
    @abstractmethod
    def _steps(self) -> FreeBodySteps:
        """Arrays and machine code of a step."""

    @abstractmethod
    def march(
        self,
        grid: np.ndarray,
        k: int,
        log: StepLog,
        last: LastImpulses,
        report: Callable[[float], None],
        stop: int | None = None,
    ) -> tuple[int, LastImpulses]:
        """Steps from instant ``k`` of the grid until instant ``stop``, by default the end, or until
        one needs the general step.

        Returns the number of the instant reached, and the last impulses.
        """

    def _placed(
        self, y: np.ndarray, displacement: np.ndarray, end: np.ndarray
    ) -> Callable[[], int]:
        """A call that places the shapes where a displacement leads from ``y``, which is written to
        ``end``."""
        arrays: Sequence[Sequence[np.ndarray]]
        arrays = [self._t, y, displacement, self._step.p], [end, *self._geometry]
        return self._places.on(*([flat(a) for a in part] for part in arrays))

    def _take_lengths(self, grid: np.ndarray, k: int) -> None:
        """Take over the length of the step that begins at instant ``k``, and of the longest one
        that may follow."""
        h, _, longest = step_lengths(grid, k, self._step.longest)
        self._t[0], self._h[0] = grid[k], h
        self._steps.set_lengths(h, longest, self._step.rest)

    def _look_ahead(self, grid: np.ndarray, k: int) -> None:
        """Place the shapes within the step that begins at instant ``k``."""
        if k < grid.size - 1:
            self._t[0], self._h[0] = grid[k], grid[k + 1] - grid[k]
            self._place_ahead()

    def _load(self, log: StepLog, last: LastImpulses) -> None:
        """Take over the state at the end of the log, and the last impulses."""
        steps, self._last = self._steps, last
        self._t[0], self._y[:], steps.v[:] = log.t, log.y, log.v
        self._place()
        steps.arms[:] = self._motion.shapes.arms(steps.corners, steps.references)
        steps.warm(*last.pressing)

    def _applied(self, forces: Callable[[], int]) -> bool:
        """Whether the forces of the step are finite."""
        return bool(forces())

    def _turned_step(self, first: Callable[[], StepOutcome] | None = None) -> StepOutcome:
        """The step, repeated with the mean speeds of its solution in the gyroscopic forces."""
        steps, before, last = self._steps, self._steps.v.copy(), np.inf
        rows, scales = self._step.smooth.turning, self._step.model.scales.displacements
        theta = self._step.scheme.theta
        outcome = StepOutcome.UNSOLVED
        if self._applied(self._forces):
            outcome = steps() if first is None else first()
        for _ in range(PATHS if rows.size else 0):
            if outcome is not StepOutcome.DONE:
                break
            mean = (before + theta * (steps.v - before))[rows]
            error = turn_error(mean, self._mean, scales[rows] / self._h)
            if error * convergence_rate(error, last) <= SAME_MEANS:
                break
            if not error < last:
                if error <= PATH_CHANGE:
                    break
                steps.remove_last()
                steps.v[:] = before
                return StepOutcome.UNSOLVED
            self._mean[:], last, steps.v[:] = mean, error, before
            outcome = steps.again() if self._applied(self._turned) else StepOutcome.UNSOLVED
        return outcome

    def _transfer(
        self,
        grid: np.ndarray,
        begin: int,
        end: int,
        log: StepLog,
        uncorrected: np.ndarray | None = None,
    ) -> int:
        """Append the recorded steps from ``begin`` to ``end`` to the log; the end.

        Parameters
        ----------
        uncorrected : (CHUNK, n_y) positions before their corrections; by default the same
        """
        steps = self._steps
        recorded = int(steps.counts[Counts.RECORDED_STEPS])
        count = min(end - begin, recorded)  # a repetition may be interrupted
        if count <= 0:
            return begin
        end = begin + count
        usual = self._step.longest
        longest = [step_lengths(grid, k, usual)[2] for k in range(begin, end)]
        paths = [self._path_of(k) for k in range(begin, end)]
        part = steps.entries(count, np.array(longest), [path.curved for path in paths])
        y, v = self._ys[:count].copy(), self._vs[:count].copy()
        before = y if uncorrected is None else uncorrected[:count].copy()
        depth = self._step.deepest(self._step.at(grid[end], y[-1]))
        depths = np.abs(np.append(steps.numbers[1:count, RecordColumns.DEPTH], depth))
        log.extend(grid[begin + 1 : end + 1], (y, before, v), depths, part, paths)
        contacts = part.key.size
        own = slice(contacts - int(part.count[-1]), contacts)
        self._last = LastImpulses((part.key[own], part.impulse[own]), part.key[:0])
        rest = recorded - count
        for states in (self._ys, self._vs, *([] if uncorrected is None else [uncorrected])):
            states[:rest] = states[count:][:rest]
        steps.forget(count, contacts)
        return end

    def _path_of(self, k: int) -> StepPath:
        """Path of step ``k``, which is transferred to the log."""
        return NO_PATH


def flat(array: np.ndarray) -> np.ndarray:
    """The same memory as one column."""
    return array.reshape(-1)
