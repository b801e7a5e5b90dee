"""Time loop of steps in machine code; steps that these cannot do are left to the general one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.analysis.nonsmooth.active_contacts import NO_PATH, PathSolution, StepPath
from dalembert.analysis.nonsmooth.advance import REPETITIONS, inexact_depth, lasting_depth
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction import correct_position, is_far
from dalembert.analysis.nonsmooth.free_bodies.free_body_loop import REPORTED, FreeBodyLoop
from dalembert.analysis.nonsmooth.free_bodies.free_body_motion import (
    FreeBodyMotion,
    free_body_motion,
)
from dalembert.analysis.nonsmooth.free_bodies.free_body_steps import CHUNK, FreeBodySteps
from dalembert.analysis.nonsmooth.free_bodies.moreau_jean_march import MoreauJeanMarch
from dalembert.analysis.nonsmooth.free_bodies.path_repeats import PathRepeats
from dalembert.analysis.nonsmooth.free_bodies.sleeping_bodies import (
    NO_SLEEP,
    SleepingBodies,
    SleepRule,
)
from dalembert.analysis.nonsmooth.step_log import StepLog
from dalembert.analysis.nonsmooth.step_state import LastImpulses, step_lengths
from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.places import Counts
from dalembert.integrators.contact.step_calls import StepOutcome
from dalembert.integrators.contact.step_places import Limits, RecordColumns


class FreeBodyMarch(FreeBodyLoop):
    """Steps of free bodies with balls, hulls and walls by the scheme of anticipated impacts.

    A step with a gap that is closed at its end is repeated with means over its path. Where the gap
    remains closed, the position at the end is corrected. A step is left to the general one if the
    impulses do not converge.

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

    sleeping: SleepingBodies

    def __init__(
        self,
        step: ContactStep,
        motion: FreeBodyMotion,
        steps: FreeBodySteps,
        rule: SleepRule | None = None,
    ):
        super().__init__(step, motion, steps)
        self._own, self.sleeping = steps, SleepingBodies(rule, motion, steps)
        self._manifold = step.model.equations.manifold
        self._part = np.zeros_like(steps.v)
        self._place_part = self._placed(self._y, self._part, self._next)
        self._repeats = PathRepeats(steps, self._manifold, step.rounding)
        self._uncorrected, self._corrected_step = np.zeros_like(self._ys), -1
        self._paths: dict[int, StepPath] = {}
        self._inexact: dict[int, float] = {}

    @property
    def _steps(self) -> FreeBodySteps:
        return self._own

    @classmethod
    def of(cls, step: ContactStep, rule: SleepRule | None = None) -> FreeBodyLoop | None:
        """The loop of the scheme, if its steps run in machine code.

        Raises
        ------
        UnsupportedError
            They do not, or are not those of anticipated impacts, and bodies are to sleep.
        """
        motion = free_body_motion(step)
        if motion is not None and step.scheme.anticipates:
            steps = FreeBodySteps(step, motion)
            if steps.available:
                return cls(step, motion, steps, rule)
        if rule is not None:
            raise UnsupportedError(NO_SLEEP)
        if motion is None or step.scheme.anticipates:
            return None
        march = MoreauJeanMarch(step, motion)
        return march if march.available else None

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
        grid = np.append(grid, 2 * grid[-1] - grid[-2])
        self._load(log, last)
        self.sleeping.begin(steps.v)
        self._look_ahead(grid, k)
        try:
            while k < stop or (k > begin and self._deepens(grid, k, begin, log)):
                self._take_lengths(grid, k)
                steps.limits[Limits.ROUNDING] = self._limit(k)
                outcome = self._attempt()
                if outcome is StepOutcome.FULL and k - begin > 1:
                    begin = self._transfer(grid, begin, k - 1, log, self._uncorrected)
                    continue
                if outcome is StepOutcome.CLOSED and k > begin:
                    if self._settled(k) or self._opened(grid, k, begin, log):
                        continue
                    k -= 1
                if outcome is not StepOutcome.DONE:
                    k -= k == stop
                    break
                if k == stop:  # the step beyond the end has only searched for closed gaps
                    steps.remove_last()
                    steps.v[:] = self._vs[k - 1 - begin]
                    break
                self._t[0] = grid[k + 1]
                if not self.sleeping.all_asleep:
                    if not self._move():
                        break
                    self._y[:] = self._next
                    self.sleeping.sleep(float(grid[k + 1] - grid[k]))
                    self._look_ahead(grid, k + 1)
                self._store(k - begin)
                k += 1
                if k - begin == CHUNK:
                    begin = self._transfer(grid, begin, k - 1, log, self._uncorrected)
                if k % REPORTED == 0:
                    report((grid[k] - grid[0]) / span)
        finally:
            self._transfer(grid, begin, k, log, self._uncorrected)
            steps.counts[[Counts.RECORDED_STEPS, Counts.RECORDED_CONTACTS]] = 0
        return k, self._last

    def _deepens(self, grid: np.ndarray, k: int, begin: int, log: StepLog) -> bool:
        """Whether gaps are closed at instant ``k``, and more than those at the instant before."""
        step, rounding = self._step, self._step.rounding
        depth = -step.deepest(step.at(grid[k], self._y))
        if depth <= rounding:
            return False
        start = self._ys[k - 2 - begin] if k - 1 > begin else log.y
        return depth > lasting_depth(-step.deepest(step.at(grid[k - 1], start)), rounding)

    def _settled(self, k: int) -> bool:
        """Whether the step that ended at instant ``k`` is not repeated for its gaps, which are as
        open as its impulses are exact; the next step then starts with these."""
        steps, gaps = self._steps, self._steps.contacts()[2]
        inexact = inexact_depth(self._step, float(steps.limits[Limits.LENGTH]), steps.fastest())
        before = abs(
            float(steps.numbers[steps.counts[Counts.RECORDED_STEPS] - 1, RecordColumns.DEPTH])
        )
        inexact = max(inexact, lasting_depth(before, self._step.rounding))
        if not self._repeats.settles(k, -float(gaps.min(initial=0.0)), inexact):
            return False
        self._inexact = {k - 1: self._limit(k - 1), k: inexact}
        return True

    def _limit(self, k: int) -> float:
        """Penetration at instant ``k`` that counts as rounding [m]."""
        return self._inexact.get(k, self._step.rounding)

    def _opened(self, grid: np.ndarray, k: int, begin: int, log: StepLog) -> bool:
        """Repeat the step that ended at instant ``k`` with means over its path; true if solved.

        The record and the state of that step are replaced; they are removed otherwise. Without
        progress, the position at its end is corrected.
        """
        steps, repeats, row = self._steps, self._repeats, k - 1 - begin
        repeats.begin(k)
        before = self._ys[row - 1] if row else log.y
        if repeats.count > REPETITIONS:
            return self._corrected(grid, k, row, before)
        last, longest = self._path_of(k - 1), step_lengths(grid, k - 1, self._step.longest)[2]
        active = steps.last_active(longest, last.curved)
        solutions = *last.solutions, PathSolution(self._vs[row].copy(), active, last.curved)
        start, length = float(grid[k - 1]), float(grid[k] - grid[k - 1])
        displacement, lists = steps.displacement.copy(), steps.lists

        def place(share: float, displacement: np.ndarray) -> None:
            self._t[0], self._part[:] = start + share * length, share * displacement
            self._place_part()

        self._y[:] = before
        steps.v[:] = self._vs[row - 1] if row else log.v
        self._take_lengths(grid, k - 1)
        steps.limits[Limits.ROUNDING] = self._limit(k - 1)
        self._look_ahead(grid, k - 1)
        selected = repeats.select(place, self._forces, displacement)
        if not selected and repeats.stalls:
            self._paths[k - 1] = last
            return self._corrected(grid, k, row, before)
        steps.remove_last()
        self.sleeping.restore()
        if not selected:
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
        self._store(row)
        self._paths[k - 1] = StepPath(repeats.keys, solutions)
        return True

    def _store(self, row: int) -> None:
        """Store the state at the end of a step, whose position is not corrected."""
        self._ys[row], self._uncorrected[row], self._vs[row] = self._y, self._y, self._steps.v

    def _corrected(self, grid: np.ndarray, k: int, row: int, before: np.ndarray) -> bool:
        """Correct the position at instant ``k``; without a near one that has open gaps, false, and
        the step from the position ``before`` that ends there is removed."""
        steps, end, t = self._steps, self._uncorrected[row], float(grid[k])
        steps.leave_path()
        travel = (t - float(grid[k - 1])) * self._vs[row][:, None]
        position = correct_position(self._step, t, end, True, travel)
        far = is_far(self._step, end, position.x, before)
        if far or not position.accepted or self._corrected_step == k:
            steps.remove_last()
            self.sleeping.restore()
            return False
        self._t[0], self._y[:], steps.v[:], self._corrected_step = t, position.x, self._vs[row], k
        self._ys[row] = position.x
        self._place()
        self._look_ahead(grid, k)
        return True

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

    def _turned_step(self, first: Callable[[], StepOutcome] | None = None) -> StepOutcome:
        asleep = self.sleeping.all_asleep
        if asleep and self._applied(self._forces) and self.sleeping.all_asleep:
            return self._steps.rest()
        return super()._turned_step(first)

    def _path_of(self, k: int) -> StepPath:
        return self._paths.pop(k, NO_PATH)
