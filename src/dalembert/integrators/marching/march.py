"""Marching with prescribed steps, in chunks that run inside CasADi."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError, SolverFailure
from dalembert.integrators.marching.checkpoints import (
    Recorder,
    Repeat,
    joined_states,
    recorder_like,
)
from dalembert.integrators.marching.steps import Schedule, Steps, Watch, even_length, run_length
from dalembert.integrators.step import Marching, Step
from dalembert.symbolic.evaluation.backends import Backend, VirtualMachine
from dalembert.symbolic.evaluation.columns import Columns
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.evaluation.prelude import before

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
        self._singles: dict[int, Marching] = {}
        self._columns: dict[int, Columns] = {}
        self._chunks: dict[tuple[int, int], Kernel] = {}
        self._preludes: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def prepare(self, count: int, mode: int) -> None:
        """Compile the functions for ``count`` steps."""
        columns = self.columns(mode)
        columns.announce(count)
        for length in (min(count, CHUNK), count % CHUNK):
            if length > 1 and self.at_once(mode):
                self._chunk(length, mode)
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
            return self._chunk(count, mode)(x, *chunk, p)[0]
        return self.columns(mode)(count, x, *chunk, self._prelude_values(mode, p))[0]

    def _chunk(self, count: int, mode: int) -> Kernel:
        """Kernel of ``count`` equal steps."""
        if (mode, count) not in self._chunks:
            self._chunks[mode, count] = Kernel(self.step_of(mode).chunk(count))
        return self._chunks[mode, count]

    def columns(self, mode: int) -> Columns:
        """Evaluator of ``single`` for many steps."""
        if mode not in self._columns:
            step = self.prepared(mode)
            self._columns[mode] = self.backend.columns(step.function, True, (4,), step.called)
        return self._columns[mode]

    def _prelude_values(self, mode: int, p: np.ndarray) -> np.ndarray:
        """``q(p)``, cached for the next chunk."""
        cached = self._preludes.get(mode)
        if cached is None or not np.array_equal(cached[0], p):
            cached = p.copy(), self.prepared(mode).values(p).full().ravel()
            self._preludes[mode] = cached
        return cached[1]

    def at_once(self, mode: int) -> bool:
        """True if equal steps are taken as chunks."""
        step = self.step_of(mode)
        return step.chunked and not branches(step, self.period)

    def single(self, mode: int) -> ca.Function:
        """``(x, t, h, flag, q) → x``; the flag says whether the step is corrected."""
        return self.prepared(mode).function

    def prepared(self, mode: int) -> Marching:
        """Functions of a step with the argument order of a march."""
        if mode not in self._singles:
            step = self.step_of(mode)
            if branches(step, self.period):
                self._singles[mode] = _single_with_flag(step, self.period)
            else:
                m = step.marching
                forms = (form and _single(form) for form in (m.called, m.lanes))
                self._singles[mode] = Marching(m.values, _single(m.function), *forms)
        return self._singles[mode]


def _single(step: ca.Function) -> ca.Function:
    """The step with the argument order of a march, for periods that need no flag."""
    kind: Any = ca.SX if step.is_a("SXFunction") else ca.MX
    t, h, x, q = (kind.sym(name, step.numel_in(i)) for i, name in enumerate("thxq"))
    flag = kind.sym("flag")
    return ca.Function("single", [x, t, h, flag, q], [step(t, h, x, q)])


def _single_with_flag(step: Step, period: int) -> Marching:
    """A step that is corrected if the flag is set."""
    call, _ = with_flag(step, period, lambda step: step.function)
    x, p = ca.MX.sym("x", step.size), ca.MX.sym("p", step.parameter_count)
    t, h, flag = ca.MX.sym("t"), ca.MX.sym("h"), ca.MX.sym("flag")
    single = ca.Function("single", [x, t, h, flag, p], [call(flag, t, h, x, p)])
    return Marching(*before(single, 4))


def branches(step: Step, period: int) -> bool:
    """True if only some of the steps are corrected."""
    return period != 1 and step.corrects


def with_flag(
    step: Step, period: int, function_of: Callable[[Step], ca.Function]
) -> tuple[Callable[..., Any], bool]:
    """``(flag, …)`` function of a step or of its derivative, and whether it is an SX function.

    The flag selects the step with or without correction; only one of them is evaluated. It is
    ignored if all steps are corrected, or none.
    """
    function = function_of(step)
    if not branches(step, period):
        return lambda flag, *arguments: function(*arguments), function.is_a("SXFunction")
    return ca.Function.if_else("branch", function, function_of(step.plain)), False
