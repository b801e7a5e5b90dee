"""Marching with steps whose length follows an estimate of the error."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from dalembert.errors import SolverFailure
from dalembert.integrators.base import Attempt
from dalembert.integrators.marching.march import FixedMarch
from dalembert.integrators.marching.steps import Crossing, Steps, Watch
from dalembert.symbolic.evaluation.backends import Backend, VirtualMachine
from dalembert.symbolic.evaluation.columns import Columns
from dalembert.symbolic.evaluation.kernel import Kernel

ATTEMPTS = 64
SMALLEST_STEP = 1e-13
"""Relative to the run or to its distance from t = 0."""


class AdaptiveMarch:
    """Attempted steps in chunks; the attempt itself keeps or refuses its step.

    Parameters
    ----------
    attempt_of : mode → Attempt
    backend : what evaluates the attempts
    fixed : repeats the steps taken, where not all states are kept
    crossed : ``(t, x, p)`` → how far the state lies beyond each switch, or None; attempts from a
        state beyond one are not made
    changes : steps may be crossed by changes that attempts do not see
    """

    def __init__(
        self,
        attempt_of: Callable[[int], Attempt],
        backend: Backend | None = None,
        fixed: FixedMarch | None = None,
        crossed: ca.Function | None = None,
        changes: bool = False,
    ):
        self.attempt_of, self.fixed, self.crossed = attempt_of, fixed, crossed
        self.changes = changes
        self.backend = backend or VirtualMachine()
        self._singles: dict[int, ca.Function] = {}
        self._columns: dict[int, Columns] = {}

    def prepare(self, mode: int) -> None:
        """Compile the attempts."""
        self.columns(mode).prepare(ATTEMPTS)

    def columns(self, mode: int) -> Columns:
        """``single`` for many attempts."""
        if mode not in self._columns:
            called = self.attempt_of(mode).called and self._whole(mode, called=True)
            self._columns[mode] = self.backend.columns(self.single(mode), True, (1,), called)
        return self._columns[mode]

    def single(self, mode: int) -> ca.Function:
        """``(state, fixed) → (state, record)`` of one attempt."""
        if mode not in self._singles:
            self._singles[mode] = self._whole(mode)
        return self._singles[mode]

    def _whole(self, mode: int, called: bool = False) -> ca.Function:
        attempt = self.attempt_of(mode)
        function = attempt.called if called else attempt.function
        assert function is not None
        return _idle_at_the_end(function, len(attempt.memory), self.crossed)

    def run(
        self,
        start: float,
        end: float,
        x0: np.ndarray,
        p: np.ndarray,
        first_step: float,
        longest: float,
        mode: int,
        watch: Watch,
    ) -> Steps:
        """March from ``start`` to ``end``; stops when the step length collapses."""
        memory = self.attempt_of(mode).memory
        state = np.concatenate([[start, first_step], memory, x0])
        fixed = np.concatenate([[end, longest], p])
        parts: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
        head, rejected, message, interrupted = 2 + len(memory), 0, "", False
        recorder = watch.recorder(x0)
        try:
            while state[0] < end and not message:
                attempts = watch.choice.attempts(mode) if watch.choice else ATTEMPTS
                out, record, failure = self._attempted(attempts, mode, state, fixed)
                made = out.shape[1]
                last = recorder.last
                out, record, following, message = self._keep(watch, out, record, last, head, mode)
                if out.shape[1] == made:  # else what failed is done again in another variant
                    message = message or failure
                taken = (record[3] > 0.5) & (record[1] > 0)
                rejected += int(np.sum((record[3] < 0.5) & (record[1] > 0)))
                t, h, columns = _finite(record[0, taken], record[1, taken], out[head:, taken])
                modes, begin = np.full(t.size, mode), state[0]
                if out.shape[1]:
                    state = out[:, -1]
                ends = np.append(t, t[-1:] + h[-1:] if t.size else begin)
                crossing = None
                whole = out.shape[1] == made and self.crossed is not None
                if (whole or self.changes) and not message:
                    crossing = watch.cross(ends, np.column_stack([last, columns]), mode)
                if crossing is not None:
                    t, h, columns, modes = _replaced(crossing, t, h, columns, modes)
                    ends = np.append(t, t[-1] + h[-1])
                    state = np.r_[ends[-1], crossing.following, memory, columns[:, -1]]
                    message = crossing.reason
                parts.append((t, h, modes))
                recorder.add(ends, columns)
                if watch.choice and following == mode and crossing is None:
                    following, length, message = watch.choice.after(record, mode, message)
                    if length is not None:
                        state = np.r_[state[0], length, memory, state[head:]]
                if crossing is None:
                    mode = following
                elif crossing.after is not None:
                    mode = crossing.after
                if message or not out.shape[1]:
                    continue
                message = _trouble(state, end - start)
                if not message and crossing is None and not np.any(record[1]):
                    message = "the side of a switch cannot be told"
                if message:
                    continue
                watch.progress((state[0] - start) / (end - start))
                if t.size and watch.stop(ends, np.column_stack([last, columns]), modes):
                    break
        except KeyboardInterrupt:
            message, interrupted = "interrupted", True
        steps = _collect(parts, start, recorder.last, rejected)
        steps.message, steps.interrupted = message, interrupted
        steps.x = recorder.states(None if self.fixed is None else self.fixed.again(steps, p))
        return steps

    def _attempted(self, attempts: int, mode: int, state: np.ndarray, fixed: np.ndarray):
        """A chunk of attempts; where a solver inside gives up, those before it and why."""
        try:
            return *self.columns(mode)(attempts, state, fixed), ""
        except SolverFailure:  # it tells neither where nor what was done before
            single, done = Kernel(self.single(mode)), []
        for _ in range(attempts):
            try:
                done.append(single(state, fixed))
            except SolverFailure as error:
                columns = [np.hstack(found) for found in zip(*done, strict=True)]
                none = [np.zeros((state.size, 0)), np.zeros((single.function.numel_out(1), 0))]
                return *(columns or none), f"a step failed: {error.reason}"
            state = done[-1][0].ravel()
        return *(np.hstack(found) for found in zip(*done, strict=True)), ""

    @staticmethod
    def _keep(watch: Watch, out, record, last, head: int, mode: int):
        """The attempts to keep, the mode after them, and why to end there, if so."""
        taken = np.flatnonzero((record[3] > 0.5) & (record[1] > 0))
        if not taken.size or not np.all(np.isfinite(out[:, taken])):
            return out, record, mode, ""
        times = np.append(record[0, taken], record[0, taken[-1]] + record[1, taken[-1]])
        columns = np.column_stack([last, out[head:, taken]])
        kept, following, reason = watch.switch(times, columns, mode)
        if kept == taken.size:
            return out, record, following, reason
        stop = taken[kept]  # everything from this attempt on is done again in the new mode
        return out[:, :stop], record[:, :stop], following, reason


def _idle_at_the_end(
    function: ca.Function, memory: int, crossed: ca.Function | None
) -> ca.Function:
    """The attempt before the end, nothing from there on, so that the rest of a chunk is free.

    Beyond a switch there is nothing either, for the step across has to be cut first.
    """
    state, fixed = ca.MX.sym("s", function.numel_in(0)), ca.MX.sym("f", function.numel_in(1))
    nothing = ca.MX.zeros(function.numel_out(1) - 1)
    idle = ca.Function("idle", [state, fixed], [state, ca.vertcat(state[0], nothing)])
    branch = ca.Function.if_else("attempt_or_idle", function, idle)
    goes_on = state[0] < fixed[0]
    if crossed is not None:
        head = 2 + memory
        x = state[head : head + crossed.numel_in(1)]
        goes_on = ca.logic_and(goes_on, ca.mmax(crossed(state[0], x, fixed[2:])) <= 0)
    outputs = branch(goes_on, state, fixed)
    return ca.Function("attempt", [state, fixed], list(outputs))


def _replaced(crossing: Crossing, t, h, columns, modes):
    """Steps up to a crossing, and those put in place of the one across."""
    kept = crossing.kept
    return (
        np.append(t[:kept], crossing.t),
        np.append(h[:kept], crossing.h),
        np.column_stack([columns[:, :kept], crossing.x]),
        np.append(modes[:kept], crossing.mode),
    )


def _trouble(state: np.ndarray, span: float) -> str:
    """Why a march over some time cannot go on from ``[t; h; …]``, or nothing."""
    if not np.all(np.isfinite(state)):
        return "the state is no longer finite"
    if state[1] < SMALLEST_STEP * max(span, abs(state[0])):
        return f"the step length fell below {state[1]:.1e} s"
    return ""


def _finite(t: np.ndarray, h: np.ndarray, columns: np.ndarray):
    """The steps up to the last state that is finite."""
    good = np.isfinite(columns).all(axis=0)
    count = good.size if good.all() else int(np.argmin(good))
    return t[:count], h[:count], columns[:, :count]


def _collect(parts, start: float, last: np.ndarray, rejected: int) -> Steps:
    """The steps without their states."""
    empty = (np.zeros(0), np.zeros(0), np.zeros(0, dtype=int))
    times, lengths, mode = (np.concatenate(part) for part in zip(empty, *parts, strict=True))
    if not times.size:
        times = np.array([start])
    return Steps(times, lengths, last, np.ones(lengths.size, bool), mode, rejected)
