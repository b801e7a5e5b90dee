"""Marching with given steps, in chunks that run inside CasADi; Python sees chunks only."""

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
from dalembert.integrators.marching.steps import Steps, Watch, even_length, run_length
from dalembert.integrators.schedule import Schedule
from dalembert.integrators.step import Marching, Step
from dalembert.symbolic.evaluation.backends import Backend, VirtualMachine
from dalembert.symbolic.evaluation.columns import Columns
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.evaluation.prelude import before

CHUNK = 500
SHORT_CHUNK = 64
"""After a change of variant, for steps beyond the next change are taken in vain."""


class FixedMarch:
    """Steps of given lengths.

    Parameters
    ----------
    step_of : mode → Step
    period : the correction follows every ``period``-th step
    backend : what evaluates the steps
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
        self._passed_on: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def prepare(self, count: int, mode: int) -> None:
        """Compile what ``count`` steps need."""
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

        A step whose equations were not solved is halved, and halved again.
        """
        h = np.diff(times)
        number = np.arange(1, h.size + 1)
        corrected = (number % self.period == 0) | (number == h.size)
        modes = np.full(h.size, mode)
        return self._march(times, h, corrected, modes, x0, p, watch.recorder(x0, h.size), watch)

    def repeat(self, steps: Steps, x0: np.ndarray, p: np.ndarray) -> Steps:
        """The steps of an earlier march from another state with other parameters."""
        for mode, count in zip(*np.unique(steps.mode, return_counts=True), strict=True):
            self.columns(int(mode)).announce(int(count))
        given = (steps.t, steps.h, steps.corrected, steps.mode)
        return self._march(*given, x0, p, recorder_like(steps.x, steps.t, x0))

    def again(self, steps: Steps, p: np.ndarray) -> Repeat:
        """Computes the states inside segments of a march."""

        def repeat(begin: int, end: int, x: np.ndarray) -> np.ndarray:
            part = slice(begin, end)
            given = (steps.t[part], steps.h[part], steps.corrected[part], steps.mode[part])
            made = self._march(*given, x, p, Recorder(x))
            if made.interrupted:
                raise KeyboardInterrupt
            if made.message:
                raise AnalysisError(
                    f"the steps from t = {steps.t[begin]:.9g} s on cannot be repeated: "
                    f"{made.message}; give the run more memory"
                )
            return made.x[:, 1:]

        return repeat

    def joined(self, steps: Steps, more: Steps, p: np.ndarray) -> Steps:
        """The steps of a march and of one that goes on from its end."""
        if not more.count:
            return replace(steps, message=more.message, interrupted=more.interrupted)
        columns = zip(*((s.t, s.h, s.corrected, s.mode) for s in (steps, more)), strict=True)
        t, h, corrected, mode = (np.concatenate(pair) for pair in columns)
        rejected = steps.rejected + more.rejected
        made = replace(more, t=t, h=h, corrected=corrected, mode=mode, rejected=rejected)
        made.x = joined_states(steps.x, more.x, self.again(made, p))
        return made

    def _march(
        self, times, h, corrected, mode, x0, p, recorder: Recorder, watch: Watch | None = None
    ) -> Steps:
        done, message, interrupted, explained = 0, "", False, False
        ahead, longest = Schedule(times[: max(h.size, 1)], h, corrected, mode), CHUNK
        try:
            while done < ahead.h.size:
                now, count = int(ahead.mode[done]), run_length(ahead.mode, done, longest)
                if self.at_once(now):
                    count = even_length(ahead.h[done : done + count])
                longest = min(2 * longest, CHUNK)
                t, length, _ = given = ahead.part(done, count)
                out, reason, explained = self.advance(now, recorder.last, given, p)
                good = np.all(np.isfinite(out), axis=0)
                valid = count if good.all() else int(np.argmin(good))
                ends = np.append(t[:valid], (t + length)[valid - 1])
                states = np.column_stack([recorder.last, out[:, :valid]])
                if watch is not None and valid:
                    kept, following, message = watch.switch(ends, states, now)
                    ahead.mode[done + kept :] = following
                    if kept < valid:
                        valid, good, longest = kept, good[:kept], SHORT_CHUNK
                recorder.add(ends[: valid + 1], out[:, :valid])
                done += valid
                if not good.all():
                    halved = watch is not None and self.halves(now, reason) and ahead.halve(done)
                    if halved:
                        longest = SHORT_CHUNK
                    else:
                        message = reason or "the state is no longer finite"
                if message:
                    break
                if watch is not None and valid:
                    watch.progress(done / ahead.h.size)
                    if watch.stop(
                        ends[: valid + 1], states[:, : valid + 1], ahead.mode[done - valid : done]
                    ):
                        break
        except KeyboardInterrupt:
            message, interrupted = "interrupted", True
        steps = Steps(
            ahead.t[: max(done, 1)],
            ahead.h[:done],
            recorder.last,
            ahead.corrected[:done],
            ahead.mode[:done],
            rejected=ahead.halved,
            message=message,
            interrupted=interrupted,
            explained=explained and bool(message),
        )
        steps.x = recorder.states(self.again(steps, p))
        return steps

    def halves(self, mode: int, reason: str) -> bool:
        """Whether a step that failed is one whose equations shorter steps may solve."""
        return not (reason or self.step_of(mode).residual is None or self.at_once(mode))

    def advance(
        self, mode: int, x: np.ndarray, given, p: np.ndarray
    ) -> tuple[np.ndarray, str, bool]:
        """States after a chunk of steps; NaN from where a solver inside gave up, and why.

        The last tells whether that is all there is to say.
        """
        count = given[0].size
        try:
            return self._advanced(count, mode, x, given, p), "", False
        except SolverFailure:  # it tells neither where nor what was done before
            out = np.full((x.size, count), np.nan)
        for k in range(count):
            try:
                here = tuple(column[k] for column in given)
                x = self._advanced(1, mode, x.ravel(), here, p)
            except SolverFailure as error:
                why = self.step_of(mode).explained(error.reason)
                return out, why or f"a step failed: {error.reason}", bool(why)
            out[:, k] = x.ravel()
        return out, "", False

    def _advanced(self, count: int, mode: int, x: np.ndarray, given, p: np.ndarray) -> np.ndarray:
        """States after ``count`` steps."""
        if count > 1 and self.at_once(mode):
            return self._chunk(count, mode)(x, *given, p)[0]
        return self.columns(mode)(count, x, *given, self._passed(mode, p))[0]

    def _chunk(self, count: int, mode: int) -> Kernel:
        """Equal steps at once."""
        if (mode, count) not in self._chunks:
            self._chunks[mode, count] = Kernel(self.step_of(mode).chunk(count))
        return self._chunks[mode, count]

    def columns(self, mode: int) -> Columns:
        """``single`` for many steps."""
        if mode not in self._columns:
            made = self.prepared(mode)
            self._columns[mode] = self.backend.columns(made.function, True, (4,), made.called)
        return self._columns[mode]

    def _passed(self, mode: int, p: np.ndarray) -> np.ndarray:
        """``q(p)``, kept for the next chunk."""
        known = self._passed_on.get(mode)
        if known is None or not np.array_equal(known[0], p):
            known = p.copy(), self.prepared(mode).values(p).full().ravel()
            self._passed_on[mode] = known
        return known[1]

    def at_once(self, mode: int) -> bool:
        """Whether equal steps are taken as chunks."""
        step = self.step_of(mode)
        return step.even and not branches(step, self.period)

    def single(self, mode: int) -> ca.Function:
        """``(x, t, h, flag, q) → x``; the flag says whether the step is corrected."""
        return self.prepared(mode).function

    def prepared(self, mode: int) -> Marching:
        """What is done once for many steps, and what is done in each."""
        if mode not in self._singles:
            step = self.step_of(mode)
            if branches(step, self.period):
                self._singles[mode] = _branching(step, self.period)
            else:
                taken = step.marching
                others = (made and _single(made) for made in (taken.called, taken.lanes))
                self._singles[mode] = Marching(taken.values, _single(taken.function), *others)
        return self._singles[mode]


def _single(step: ca.Function) -> ca.Function:
    """The step in the order of a march; every step is corrected, or none, so the flag is unseen."""
    kind: Any = ca.SX if step.is_a("SXFunction") else ca.MX
    t, h, x, q = (kind.sym(name, step.numel_in(i)) for i, name in enumerate("thxq"))
    flag = kind.sym("flag")
    return ca.Function("single", [x, t, h, flag, q], [step(t, h, x, q)])


def _branching(step: Step, period: int) -> Marching:
    """A step of which the flag decides whether it is corrected."""
    call, _ = flagged(step, period, lambda step: step.function)
    x, p = ca.MX.sym("x", step.size), ca.MX.sym("p", step.parameter_count)
    t, h, flag = ca.MX.sym("t"), ca.MX.sym("h"), ca.MX.sym("flag")
    single = ca.Function("single", [x, t, h, flag, p], [call(flag, t, h, x, p)])
    return Marching(*before(single, 4))


def branches(step: Step, period: int) -> bool:
    """Some of the steps are corrected, some are not."""
    return period != 1 and step.corrects


def flagged(
    step: Step, period: int, function_of: Callable[[Step], ca.Function]
) -> tuple[Callable[..., Any], bool]:
    """``(flag, …)`` function of a step or of its derivative; and whether it is one of scalars.

    The flag says whether the step is corrected; of the two only one is evaluated. Where every
    step is, or none, it goes unseen.
    """
    function = function_of(step)
    if not branches(step, period):
        return lambda flag, *arguments: function(*arguments), function.is_a("SXFunction")
    return ca.Function.if_else("branch", function, function_of(step.plain)), False
