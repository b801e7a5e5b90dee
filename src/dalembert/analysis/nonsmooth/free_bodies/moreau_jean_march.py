"""Time loop of steps in machine code by the scheme of Moreau and Jean."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.analysis.nonsmooth.advance import REPETITIONS
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction import SETTINGS, exceeds
from dalembert.analysis.nonsmooth.free_bodies.free_body_loop import REPORTED, FreeBodyLoop
from dalembert.analysis.nonsmooth.free_bodies.free_body_motion import FreeBodyMotion
from dalembert.analysis.nonsmooth.free_bodies.free_body_steps import CHUNK
from dalembert.analysis.nonsmooth.free_bodies.moreau_jean_steps import MoreauJeanSteps
from dalembert.analysis.nonsmooth.step_log import StepLog
from dalembert.analysis.nonsmooth.step_state import LastImpulses
from dalembert.integrators.contact.places import Counts
from dalembert.integrators.contact.step_calls import StepOutcome
from dalembert.integrators.contact.step_places import RecordColumns
from dalembert.symbolic.evaluation.fixed_call import FixedCalls


class MoreauJeanMarch(FreeBodyLoop):
    """Steps with the contacts that a correction of positions would open, and this correction, as in
    ``advance`` and ``correct_position``.

    A step is left to the general one, which searches for such impacts, if it may miss one, and if
    its impulses or positions do not converge.

    Parameters
    ----------
    step : ContactStep
    motion : functions of the step
    """

    def __init__(self, step: ContactStep, motion: FreeBodyMotion):
        self._own = MoreauJeanSteps(step, motion)
        super().__init__(step, motion, self._own)
        self._scales, self._projects = step.model.scales.displacements, step.scheme.projection
        self._uncorrected, self._corrected = np.zeros_like(self._ys), np.zeros_like(self._y)
        self._correct = self._placed(self._next, self._own.displacement, self._corrected)
        mass = FixedCalls(motion.mass, compiled=False)
        self._mass = mass.on([self._next, step.p], [self._own.mass])

    @property
    def _steps(self) -> MoreauJeanSteps:
        return self._own

    @property
    def available(self) -> bool:
        """Whether there is machine code."""
        return self._own.available

    def march(
        self,
        grid: np.ndarray,
        k: int,
        log: StepLog,
        last: LastImpulses,
        report: Callable[[float], None],
        stop: int | None = None,
    ) -> tuple[int, LastImpulses]:
        steps, span, begin = self._steps, grid[-1] - grid[0], k
        stop = grid.size - 1 if stop is None else stop
        self._load(log, last)
        try:
            while k < stop:
                self._take_lengths(grid, k)
                self._look_ahead(grid, k)
                outcome = self._attempt(float(grid[k]), float(grid[k + 1]), k - begin)
                if outcome is StepOutcome.FULL and k > begin:
                    begin = self._transfer(grid, begin, k, log, self._uncorrected)
                    continue
                if outcome is not StepOutcome.DONE:
                    break
                self._y[:] = self._next
                self._ys[k - begin], self._vs[k - begin] = self._y, steps.v
                k += 1
                if k - begin == CHUNK:
                    begin = self._transfer(grid, begin, k, log, self._uncorrected)
                if k % REPORTED == 0:
                    report((grid[k] - grid[0]) / span)
        finally:
            self._transfer(grid, begin, k, log, self._uncorrected)
            steps.counts[[Counts.RECORDED_STEPS, Counts.RECORDED_CONTACTS]] = 0
        return k, self._last

    def _attempt(self, start: float, end: float, row: int) -> StepOutcome:
        """A step, and the correction of its end, which is written with the uncorrected one."""
        steps, before = self._steps, self._steps.v.copy()
        outcome = self._turned_step()
        for repetition in range(REPETITIONS + 1):
            if outcome is not StepOutcome.DONE:
                return outcome
            self._t[0] = end
            at_end = steps.at_end() if self._move() else StepOutcome.UNSOLVED
            if at_end not in (StepOutcome.DONE, StepOutcome.CLOSED):
                return StepOutcome.UNSOLVED
            if not steps.adds or repetition == REPETITIONS:
                break
            self._t[0] = start
            outcome = self._with_added(before)
            if outcome is StepOutcome.UNCHANGED:
                self._t[0] = end
                self._move()
                break
        if steps.misses:
            return StepOutcome.UNSOLVED
        self._uncorrected[row] = self._next
        if at_end is StepOutcome.DONE or not self._projects:
            return StepOutcome.DONE
        return self._opened()

    def _with_added(self, before: np.ndarray) -> StepOutcome:
        """The step from the speeds ``before`` with the contacts that are added to its own, unless
        they supply energy."""
        steps, after, depth = self._steps, self._steps.v.copy(), -self._steps.deepest
        loss = steps.numbers[steps.counts[Counts.RECORDED_STEPS] - 1, RecordColumns.LOSS]
        steps.v[:] = before
        if steps.adds_others:
            self._place()
        outcome = self._turned_step(steps.joined)
        if outcome is StepOutcome.UNCHANGED:
            steps.v[:] = after
        elif outcome is StepOutcome.DONE:
            own = steps.numbers[steps.counts[Counts.RECORDED_STEPS] - 1, RecordColumns.LOSS]
            if own < min(loss, -steps.allowed_work(depth)):
                steps.v[:] = before
                parted = self._turned_step(steps.parted)
                outcome = StepOutcome.UNCHANGED if parted is StepOutcome.DONE else parted
        return outcome

    def _opened(self) -> StepOutcome:
        """Open the gaps at the end, where the shapes are."""
        steps, travel, shift, last = self._steps, self._size(), 0.0, np.inf
        for _ in range(SETTINGS.max_iterations):
            if not self._mass():
                return StepOutcome.UNSOLVED
            outcome = steps.correction()
            if outcome is StepOutcome.DONE:
                return outcome
            shift, depth = shift + self._size(), -steps.deepest
            stalls = depth > last / 2 and SETTINGS.near(last / self._step.rounding)
            if outcome is not StepOutcome.CLOSED or stalls or exceeds(shift, travel):
                break
            if not self._correct():
                break
            self._next[:], last = self._corrected, depth
        return StepOutcome.UNSOLVED

    def _size(self) -> float:
        """The largest displacement in the arrays, by the natural ones [-]."""
        return float(np.abs(self._steps.displacement / self._scales).max(initial=0.0))
