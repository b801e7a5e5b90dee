"""Time loop of steps in machine code; steps that these cannot do are left to the general one."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from dalembert.analysis.nonsmooth.advance import REPETITIONS, inexact_depth
from dalembert.analysis.nonsmooth.contact_step import PATHS, SAME_MEANS, ContactStep
from dalembert.analysis.nonsmooth.free_bodies.free_body_motion import (
    FreeBodyMotion,
    free_body_motion,
)
from dalembert.analysis.nonsmooth.free_bodies.free_body_steps import CHUNK, FreeBodySteps
from dalembert.analysis.nonsmooth.free_bodies.path_repeats import PathRepeats
from dalembert.analysis.nonsmooth.free_bodies.recorded_contacts import PRESSING, STEPS
from dalembert.analysis.nonsmooth.free_bodies.sleeping_bodies import (
    NO_SLEEP,
    SleepingBodies,
    SleepRule,
)
from dalembert.analysis.nonsmooth.free_bodies.step_outcome import DEPTH, StepOutcome
from dalembert.analysis.nonsmooth.gyroscopic import turn_error
from dalembert.analysis.nonsmooth.step_log import StepLog
from dalembert.analysis.nonsmooth.step_state import (
    PATH_CHANGE,
    LastImpulses,
    convergence_rate,
)
from dalembert.errors import UnsupportedError
from dalembert.symbolic.evaluation.fixed_call import FixedCalls

REPORTED = 16
"""Number of steps between reports of the progress."""


class FreeBodyMarch:
    """Steps of free bodies with balls, hulls and walls.

    A step with a gap that is closed at its end is repeated with means over its path. It is left to
    the general step if the impulses do not converge, or the gap remains closed.

    Parameters
    ----------
    step : ContactStep
    motion : functions of the step
    steps : arrays and machine code of a step
    rule : when bodies sleep; None: never

    Attributes
    ----------
    sleeping : SleepingBodies
    """

    def __init__(
        self,
        step: ContactStep,
        motion: FreeBodyMotion,
        steps: FreeBodySteps,
        rule: SleepRule | None = None,
    ):
        self._step, self._motion, self._steps = step, motion, steps
        self.sleeping = SleepingBodies(rule, motion, steps)
        self._t, self._h = np.zeros(1), np.zeros(1)
        self._y = np.zeros(step.model.equations.coordinate_count)
        self._next, self._still = np.zeros_like(self._y), np.zeros_like(steps.v)
        self._ys, self._vs = np.zeros((CHUNK, self._y.size)), np.zeros((CHUNK, steps.v.size))
        places, t, v, p = FixedCalls(motion.places, compiled=False), self._t, steps.v, step.p
        geometry = steps.corners, steps.references, steps.normals, steps.velocities
        forces = FixedCalls(motion.forces, compiled=False)
        state, mean = [t, self._y, v, p, self._h], np.zeros(step.smooth.turning.size)
        self._forces = forces.on(state, [steps.force, steps.inertia, mean])
        turned = FixedCalls(motion.turned, compiled=False)
        self._turned = turned.on([*state, mean], [steps.force, steps.inertia])
        self._mean = mean
        self._manifold = step.model.equations.manifold
        self._part = np.zeros_like(steps.v)

        def placed(t: np.ndarray, displacement: np.ndarray, geometry: Sequence[np.ndarray]):
            arrays = [t, self._y, displacement, p], [self._next, *geometry]
            return places.on(*([flat(a) for a in part] for part in arrays))

        self._move = placed(t, steps.displacement, geometry)
        self._place_part = placed(t, self._part, geometry)
        self._place = placed(t, self._still, geometry)
        ahead = FixedCalls(motion.ahead, compiled=False)
        self._place_middle = ahead.on(state, [flat(part) for part in steps.ahead])
        self._repeats = PathRepeats(steps, self._manifold, step.rounding)
        self._curved: dict[int, np.ndarray] = {}
        self._inexact: dict[int, float] = {}

    @classmethod
    def of(cls, step: ContactStep, rule: SleepRule | None = None) -> FreeBodyMarch | None:
        """The loop, if the steps run in machine code.

        Raises
        ------
        UnsupportedError
            They do not, and bodies are to sleep.
        """
        motion = free_body_motion(step)
        steps = None if motion is None else FreeBodySteps(step, motion)
        if motion is not None and steps is not None and steps.available:
            return cls(step, motion, steps, rule)
        if rule is not None:
            raise UnsupportedError(NO_SLEEP)
        return None

    def march(
        self,
        grid: np.ndarray,
        k: int,
        log: StepLog,
        last: LastImpulses,
        report: Callable[[float], None],
    ) -> tuple[int, LastImpulses]:
        """Steps from instant ``k`` of the grid until the end, or until one needs the general step.

        Returns the number of the instant reached, and the last impulses.
        """
        steps, span, self._last = self._steps, grid[-1] - grid[0], last
        self._load(log)
        self._look_ahead(grid, k)
        begin = k
        try:
            while k < grid.size - 1:
                self._t[0], self._h[0] = grid[k], grid[k + 1] - grid[k]
                steps.limits[0], steps.limits[2] = self._h[0], self._limit(k)
                outcome = self._attempt()
                if outcome is StepOutcome.FULL and k - begin > 1:
                    begin = self._transfer(grid, begin, k - 1, log)
                    continue
                if outcome is StepOutcome.CLOSED and k > begin:
                    if self._settled(k) or self._opened(grid, k, begin, log):
                        continue
                    k -= 1
                if outcome is not StepOutcome.DONE:
                    break
                self._t[0] = grid[k + 1]
                if not self.sleeping.all_asleep:
                    if not self._move():
                        break
                    self._y[:] = self._next
                    self.sleeping.sleep(float(grid[k + 1] - grid[k]))
                    self._look_ahead(grid, k + 1)
                self._ys[k - begin], self._vs[k - begin] = self._y, steps.v
                k += 1
                if k - begin == CHUNK:
                    begin = self._transfer(grid, begin, k - 1, log)
                if k % REPORTED == 0:
                    report((grid[k] - grid[0]) / span)
            else:
                end = self._step.at(grid[-1], self._y)
                if k > begin and self._step.deepest(end) < -self._step.rounding:
                    k -= 1
        finally:
            self._transfer(grid, begin, k, log)
            steps.counts[[STEPS, PRESSING]] = 0
        return k, self._last

    def _look_ahead(self, grid: np.ndarray, k: int) -> None:
        """Place the shapes in the middle of the step that begins at instant ``k``."""
        if k < grid.size - 1:
            self._t[0], self._h[0] = grid[k], grid[k + 1] - grid[k]
            self._place_middle()

    def _settled(self, k: int) -> bool:
        """Whether the step that ended at instant ``k`` is not repeated for its gaps, which are as
        open as its impulses are exact; the next step then starts with these."""
        steps, gaps = self._steps, self._steps.contacts()[2]
        inexact = inexact_depth(self._step, float(steps.limits[0]), steps.fastest())
        if not self._repeats.settles(k, -float(gaps.min(initial=0.0)), inexact):
            return False
        self._inexact = {k - 1: self._limit(k - 1), k: inexact}
        return True

    def _limit(self, k: int) -> float:
        """Penetration at instant ``k`` that counts as rounding [m]."""
        return self._inexact.get(k, self._step.rounding)

    def _opened(self, grid: np.ndarray, k: int, begin: int, log: StepLog) -> bool:
        """Repeat the step that ended at instant ``k`` with means over its path; true if solved.

        The record and the state of that step are replaced.
        """
        steps, repeats, row = self._steps, self._repeats, k - 1 - begin
        repeats.begin(k)
        steps.remove_last()
        self.sleeping.restore()
        self._curved.pop(k, None)
        if repeats.count > REPETITIONS:
            return False
        start, length = float(grid[k - 1]), float(grid[k] - grid[k - 1])
        displacement, lists = steps.displacement.copy(), steps.lists

        def place(share: float, displacement: np.ndarray) -> None:
            self._t[0], self._part[:] = start + share * length, share * displacement
            self._place_part()

        self._y[:] = self._ys[row - 1] if row else log.y
        steps.v[:] = self._vs[row - 1] if row else log.v
        self._h[0] = steps.limits[0] = length
        steps.limits[2] = self._limit(k - 1)
        self._look_ahead(grid, k - 1)
        if not repeats.select(place, self._forces, displacement):
            steps.leave_path()
            return False
        repeats.average(place, displacement)
        place(0.0, displacement)
        outcome = self._attempt()
        steps.leave_path()
        self._t[0] = grid[k]
        if outcome is not StepOutcome.DONE or steps.lists > lists or not self._move():
            return False
        self._y[:] = self._next
        self._look_ahead(grid, k)
        self._ys[row], self._vs[row] = self._y, steps.v
        self._curved[k] = repeats.keys
        return True

    def _load(self, log: StepLog) -> None:
        """Take over the state at the end of the log, and the last impulses."""
        steps = self._steps
        self._t[0], self._y[:], steps.v[:] = log.t, log.y, log.v
        self._place()
        steps.arms[:] = self._motion.shapes.arms(steps.corners, steps.references)
        steps.warm(*self._last.pressing)
        self.sleeping.begin(steps.v)

    def _attempt(self) -> StepOutcome:
        """The step, repeated where it wakes bodies that sleep."""
        steps, before = self._steps, self._steps.v.copy()
        outcome = self._turned_step()
        while outcome is StepOutcome.DONE and self.sleeping.wakes():
            steps.remove_last()
            steps.v[:] = before
            outcome = StepOutcome.UNSOLVED if steps.on_path else self._turned_step()
        if outcome is StepOutcome.DONE:
            self.sleeping.record()
        return outcome

    def _applied(self, forces: Callable[[], int]) -> bool:
        """Whether forces of the step, without those on sleeping bodies, are finite."""
        finite = bool(forces())
        return finite and not (self.sleeping.remove_forces() and self._steps.on_path)

    def _turned_step(self) -> StepOutcome:
        """The step, repeated with the mean speeds of its solution in the gyroscopic forces."""
        steps, before, last = self._steps, self._steps.v.copy(), np.inf
        rows, scales = self._step.smooth.turning, self._step.model.scales.displacements
        finite = self._applied(self._forces)
        if finite and self.sleeping.all_asleep:
            return steps.rest()
        outcome = steps() if finite else StepOutcome.UNSOLVED
        for _ in range(PATHS if rows.size else 0):
            if outcome is not StepOutcome.DONE:
                break
            mean = ((before + steps.v) / 2)[rows]
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

    def _transfer(self, grid: np.ndarray, begin: int, end: int, log: StepLog) -> int:
        """Append the recorded steps from ``begin`` to ``end`` to the log; the end."""
        steps = self._steps
        count = min(end - begin, int(steps.counts[STEPS]))  # a repetition may be interrupted
        if count <= 0:
            return begin
        end = begin + count
        curved = {k - 1 - begin: self._curved.pop(k) for k in [*self._curved] if begin < k <= end}
        part = steps.entries(count, self._step.longest, curved)
        y, v = self._ys[:count].copy(), self._vs[:count].copy()
        depth = self._step.deepest(self._step.at(grid[end], y[-1]))
        depths = np.abs(np.append(steps.numbers[1:count, DEPTH], depth))
        log.extend(grid[begin + 1 : end + 1], y, v, depths, part)
        contacts = part.key.size
        own = slice(contacts - int(part.count[-1]), contacts)
        self._last = LastImpulses((part.key[own], part.impulse[own]), part.key[:0])
        rest = int(steps.counts[STEPS]) - count
        self._ys[:rest], self._vs[:rest] = self._ys[count:][:rest], self._vs[count:][:rest]
        steps.forget(count, contacts)
        return end


def flat(array: np.ndarray) -> np.ndarray:
    """The same memory as one column."""
    return array.reshape(-1)
