"""Marching with prescribed steps, in chunks that run inside CasADi."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from dalembert.errors import AnalysisError, SolverFailure
from dalembert.integrators.marching.checkpoints import (
    Recorder,
    Repeat,
    joined_states,
    recorder_like,
)
from dalembert.integrators.marching.loop import StepSource, Stretch, take_steps
from dalembert.integrators.marching.marched_step import MarchedStep
from dalembert.integrators.marching.steps import (
    Crossing,
    Samples,
    Schedule,
    Steps,
    Watch,
    even_length,
    run_length,
)
from dalembert.integrators.step import Step
from dalembert.symbolic.evaluation.backends import Backend, VirtualMachine
from dalembert.symbolic.evaluation.columns import Columns

CHUNK = 500
"""Maximum number of steps per call."""
SHORT_CHUNK = 64
"""Number of steps per call after a change of variant; steps beyond the next one are wasted."""


class FixedMarch:
    """March with steps of prescribed lengths.

    Parameters
    ----------
    step_of : mode → Step
    period : the correction follows every ``period``-th step
    backend : evaluator of the steps
    """

    def __init__(
        self,
        step_of: Callable[[int], Step],
        period: int = 1,
        backend: Backend | None = None,
    ):
        self.step_of, self.period = step_of, period
        self.backend = backend or VirtualMachine()
        self._marched: dict[int, MarchedStep] = {}
        self._columns: dict[int, Columns] = {}
        self._preludes: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def prepare(self, count: int, mode: int) -> None:
        """Compile the functions for ``count`` steps."""
        columns = self.columns(mode)
        columns.announce(count)
        for length in (min(count, CHUNK), count % CHUNK):
            if length > 1 and self.at_once(mode):
                self.marched(mode).chunk(length)
            elif length:
                columns.prepare(length)

    def run(
        self,
        times: np.ndarray,
        x0: np.ndarray,
        p: np.ndarray,
        mode: int,
        watch: Watch,
        events: bool = False,
        samples: Samples | None = None,
    ) -> Steps:
        """March over the grid ``times``; stops at the first state that is not finite.

        A step in which Newton's method fails is halved, repeatedly if necessary.

        Parameters
        ----------
        times : grid [s]
        x0, p, mode : first state, parameters and mode
        watch : callbacks
        events : whether steps are cut at the events that ``watch.cross`` finds inside them
        samples : transitions at fixed times
        """
        schedule = Schedule.on_grid(times, self.period, mode, samples)
        recorder = watch.recorder(x0, 0 if events else schedule.h.size)
        return self._march(schedule, p, recorder, watch, events, mode, samples)

    def repeat(self, steps: Steps, x0: np.ndarray, p: np.ndarray) -> Steps:
        """Repeat the steps of an earlier march from another state with other parameters."""
        for mode, count in zip(*np.unique(steps.mode, return_counts=True), strict=True):
            self.columns(int(mode)).announce(int(count))
        return self._march(steps.schedule(), p, recorder_like(steps.x, steps.t, x0))

    def again(self, steps: Steps, p: np.ndarray) -> Repeat:
        """Function that recomputes the states inside segments of a march."""

        def repeat(begin: int, end: int, x: np.ndarray) -> np.ndarray:
            segment = self._march(steps.schedule(begin, end), p, Recorder(x))
            if segment.interrupted:
                raise KeyboardInterrupt
            if segment.message:
                raise AnalysisError(
                    f"the steps from t = {steps.t[begin]:.9g} s on cannot be repeated: "
                    f"{segment.message}; give the run more memory"
                )
            return segment.x[:, 1:]

        return repeat

    def joined(self, steps: Steps, more: Steps, p: np.ndarray) -> Steps:
        """The steps of a march and of its continuation."""
        if not more.count:
            return replace(steps, message=more.message, interrupted=more.interrupted)
        columns = zip(*((s.t, s.h, s.corrected, s.mode) for s in (steps, more)), strict=True)
        t, h, corrected, mode = (np.concatenate(pair) for pair in columns)
        rejected = steps.rejected + more.rejected
        joined = replace(more, t=t, h=h, corrected=corrected, mode=mode, rejected=rejected)
        joined.x = joined_states(steps.x, more.x, self.again(joined, p))
        return joined

    def _march(
        self,
        schedule: Schedule,
        p: np.ndarray,
        recorder: Recorder,
        watch: Watch | None = None,
        events: bool = False,
        mode: int | None = None,
        samples: Samples | None = None,
    ) -> Steps:
        first = schedule.mode[0] if mode is None and schedule.mode.size else mode or 0
        search = events, watch is not None
        source = PrescribedSteps(self, schedule, p, *search, int(first), samples)
        steps = take_steps(source, recorder, watch or Watch())
        steps.x = recorder.states(self.again(steps, p))
        return steps

    def halves(self, mode: int, reason: str) -> bool:
        """True if Newton's method may succeed in shorter steps after a failed one."""
        return not (reason or self.step_of(mode).residual is None or self.at_once(mode))

    def advance(
        self, mode: int, x: np.ndarray, chunk, p: np.ndarray
    ) -> tuple[np.ndarray, str, bool]:
        """States after a chunk of steps, NaN after the failure of an inner solver, and its reason.

        The flag is True if the reason is a complete explanation.
        """
        count = chunk[0].size
        try:
            return self._states_after(count, mode, x, chunk, p), "", False
        except SolverFailure:  # reports neither the step nor the states before it
            out = np.full((x.size, count), np.nan)
        for k in range(count):
            try:
                step = tuple(column[k] for column in chunk)
                x = self._states_after(1, mode, x.ravel(), step, p)
            except SolverFailure as error:
                text = self.step_of(mode).explain(error.reason)
                return out, text or f"a step failed: {error.reason}", bool(text)
            out[:, k] = x.ravel()
        return out, "", False

    def _states_after(
        self, count: int, mode: int, x: np.ndarray, chunk, p: np.ndarray
    ) -> np.ndarray:
        """States after ``count`` steps."""
        if count > 1 and self.at_once(mode):
            return self.marched(mode).chunk(count)(x, *chunk, p)[0]
        return self.columns(mode)(count, x, *chunk, self._prelude_values(mode, p))[0]

    def columns(self, mode: int) -> Columns:
        """Evaluator of many steps."""
        if mode not in self._columns:
            forms = self.marched(mode).forms
            self._columns[mode] = self.backend.columns(forms.function, True, (4,), forms.called)
        return self._columns[mode]

    def _prelude_values(self, mode: int, p: np.ndarray) -> np.ndarray:
        """``q(p)``, cached for the next chunk."""
        cached = self._preludes.get(mode)
        if cached is None or not np.array_equal(cached[0], p):
            cached = p.copy(), self.marched(mode).forms.values(p).full().ravel()
            self._preludes[mode] = cached
        return cached[1]

    def at_once(self, mode: int) -> bool:
        """True if equal steps are taken as chunks."""
        return self.marched(mode).at_once

    def marched(self, mode: int) -> MarchedStep:
        """The step of a mode in the order of arguments of marches."""
        if mode not in self._marched:
            self._marched[mode] = MarchedStep(self.step_of(mode), self.period)
        return self._marched[mode]


class PrescribedSteps(StepSource):
    """Steps of a schedule.

    Parameters
    ----------
    march : FixedMarch
    schedule : Schedule; halved steps and steps cut by events replace its own
    p : (np,) parameters
    events : whether there may be events inside steps
    halves : whether steps in which Newton's method fails are halved
    mode : of the first steps
    samples : transitions in the schedule
    """

    def __init__(
        self,
        march: FixedMarch,
        schedule: Schedule,
        p: np.ndarray,
        events: bool,
        halves: bool,
        mode: int,
        samples: Samples | None = None,
    ):
        self.march, self.schedule, self.p = march, schedule, p
        self.events, self.halves = events, halves
        self.start, self.done = float(schedule.t[0]), 0
        self.longest = SHORT_CHUNK if events else CHUNK
        self.reason, self.mode, self.samples = "", mode, samples

    @property
    def pending(self) -> bool:
        return self.done < self.schedule.h.size

    @property
    def progress(self) -> float:
        return self.done / self.schedule.h.size

    def take(self, time: float, x: np.ndarray) -> tuple[Stretch, str]:
        mode, due = self.mode, -1 - int(self.schedule.mode[self.done])
        self.sampling = due >= 0
        if self.sampling:
            assert self.samples is not None
            mode = self.samples.mode(mode, due)
        chunk, count = self._chunk(mode)
        out, self.reason, self.explained = self.march.advance(mode, x, chunk, self.p)
        t, h, corrected = (column[:count] for column in chunk)
        stretch = Stretch.of(time, x, out[:, :count], t, h, corrected, np.full(count, mode))
        failed = stretch.count < count
        return stretch, (self.reason or "the state is no longer finite") if failed else ""

    def _chunk(self, mode: int) -> tuple[tuple[np.ndarray, ...], int]:
        """Times, lengths and flags of the next steps, and their number.

        With events, when the number of steps ahead varies, they are padded with steps of zero
        length to the fixed size of a chunk.
        """
        s, at_once = self.schedule, self.march.at_once(mode)
        count = run_length(s.mode, self.done, self.longest)
        if at_once:
            count = even_length(s.h[self.done : self.done + count])
        t, h, corrected = s.part(self.done, count)
        if self.sampling:
            return (t[:1], h[:1], corrected[:1]), 1
        if not self.events:
            self.longest = min(2 * self.longest, CHUNK)
        elif not at_once and (missing := SHORT_CHUNK - count) > 0:
            t = np.append(t, np.full(missing, t[-1] + h[-1]))
            h, corrected = np.append(h, np.zeros(missing)), np.append(corrected, [True] * missing)
        return (t, h, corrected), count

    def reject(self, accepted: int) -> None:
        self.longest = SHORT_CHUNK

    def may_cross(self, reason: str) -> bool:
        return self.events

    def settle(
        self, stretch: Stretch, following: int, crossing: Crossing | None, failure: str
    ) -> str:
        schedule = self.schedule
        if crossing is None:
            self.done += stretch.count
        else:
            self.done = schedule.resume(self.done + crossing.accepted, float(stretch.ends[-1]))
        if following != self.mode:
            later = schedule.mode[self.done :]
            later[later >= 0] = following
        may_halve = failure and self.halves and self.march.halves(self.mode, self.reason)
        if may_halve and schedule.halve(self.done):
            self.longest, self.rejected, failure = SHORT_CHUNK, schedule.halved, ""
        following = int(schedule.mode[self.done]) if self.pending else following
        self.mode = following if following >= 0 else self.mode
        return failure
