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
from dalembert.integrators.marching.marched_step import MarchedStep
from dalembert.integrators.marching.steps import Schedule, Steps, Watch, even_length, run_length
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
        self, times: np.ndarray, x0: np.ndarray, p: np.ndarray, mode: int, watch: Watch
    ) -> Steps:
        """March over the grid ``times``; stops at the first state that is not finite.

        A step in which Newton's method fails is halved, repeatedly if necessary.
        """
        h = np.diff(times)
        number = np.arange(1, h.size + 1)
        corrected = (number % self.period == 0) | (number == h.size)
        modes = np.full(h.size, mode)
        return self._march(times, h, corrected, modes, x0, p, watch.recorder(x0, h.size), watch)

    def repeat(self, steps: Steps, x0: np.ndarray, p: np.ndarray) -> Steps:
        """Repeat the steps of an earlier march from another state with other parameters."""
        for mode, count in zip(*np.unique(steps.mode, return_counts=True), strict=True):
            self.columns(int(mode)).announce(int(count))
        schedule = steps.t, steps.h, steps.corrected, steps.mode
        return self._march(*schedule, x0, p, recorder_like(steps.x, steps.t, x0))

    def again(self, steps: Steps, p: np.ndarray) -> Repeat:
        """Function that recomputes the states inside segments of a march."""

        def repeat(begin: int, end: int, x: np.ndarray) -> np.ndarray:
            part = slice(begin, end)
            schedule = steps.t[part], steps.h[part], steps.corrected[part], steps.mode[part]
            segment = self._march(*schedule, x, p, Recorder(x))
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
        self, times, h, corrected, mode, x0, p, recorder: Recorder, watch: Watch | None = None
    ) -> Steps:
        done, message, interrupted, explained = 0, "", False, False
        schedule, longest = Schedule(times[: max(h.size, 1)], h, corrected, mode), CHUNK
        try:
            while done < schedule.h.size:
                now = int(schedule.mode[done])
                count = run_length(schedule.mode, done, longest)
                if self.at_once(now):
                    count = even_length(schedule.h[done : done + count])
                longest = min(2 * longest, CHUNK)
                t, length, _ = chunk = schedule.part(done, count)
                out, reason, explained = self.advance(now, recorder.last, chunk, p)
                finite = np.all(np.isfinite(out), axis=0)
                valid = count if finite.all() else int(np.argmin(finite))
                ends = np.append(t[:valid], (t + length)[valid - 1])
                states = np.column_stack([recorder.last, out[:, :valid]])
                if watch is not None and valid:
                    accepted, following, message = watch.switch(ends, states, now)
                    schedule.mode[done + accepted :] = following
                    if accepted < valid:
                        valid, finite, longest = accepted, finite[:accepted], SHORT_CHUNK
                recorder.add(ends[: valid + 1], out[:, :valid])
                done += valid
                if not finite.all():
                    may_halve = watch is not None and self.halves(now, reason)
                    if may_halve and schedule.halve(done):
                        longest = SHORT_CHUNK
                    else:
                        message = reason or "the state is no longer finite"
                if message:
                    break
                if watch is not None and valid:
                    watch.progress(done / schedule.h.size)
                    if watch.stop(
                        ends[: valid + 1],
                        states[:, : valid + 1],
                        schedule.mode[done - valid : done],
                    ):
                        break
        except KeyboardInterrupt:
            message, interrupted = "interrupted", True
        steps = Steps(
            schedule.t[: max(done, 1)],
            schedule.h[:done],
            recorder.last,
            schedule.corrected[:done],
            schedule.mode[:done],
            rejected=schedule.halved,
            message=message,
            interrupted=interrupted,
            explained=explained and bool(message),
        )
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
