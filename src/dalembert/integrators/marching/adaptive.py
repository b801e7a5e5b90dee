"""Marching with adaptive step size."""

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
"""Number of attempts per call."""
SMALLEST_STEP = 1e-13
"""Lower limit of the step, relative to the length of the run and to |t| [-]."""


class AdaptiveMarch:
    """March with attempted steps in chunks; the attempt itself accepts or rejects its step.

    Parameters
    ----------
    attempt_of : mode → Attempt
    backend : evaluator of the attempts
    fixed : march that recomputes states between checkpoints, if not all are stored
    crossed : ``(t, x, p)`` → distance of the state beyond each switch, or None; no step is
        attempted from a state beyond a switch
    changes : True if contact changes, which attempts do not detect, may occur within steps
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
        """Evaluator of ``single`` for many attempts."""
        if mode not in self._columns:
            called = self.attempt_of(mode).called and self._attempt_or_idle(mode, called=True)
            self._columns[mode] = self.backend.columns(self.single(mode), True, (1,), called)
        return self._columns[mode]

    def single(self, mode: int) -> ca.Function:
        """``(state, fixed) → (state, record)`` of one attempt."""
        if mode not in self._singles:
            self._singles[mode] = self._attempt_or_idle(mode)
        return self._singles[mode]

    def _attempt_or_idle(self, mode: int, called: bool = False) -> ca.Function:
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
                out, record, failure = self._attempt_chunk(attempts, mode, state, fixed)
                count = out.shape[1]
                last = recorder.last
                out, record, following, message = self._valid(watch, out, record, last, head, mode)
                if out.shape[1] == count:  # else the failed attempt is repeated in another variant
                    message = message or failure
                accepted = (record[3] > 0.5) & (record[1] > 0)
                rejected += int(np.sum((record[3] < 0.5) & (record[1] > 0)))
                steps_taken = record[0, accepted], record[1, accepted]
                t, h, columns = _finite(*steps_taken, out[head:, accepted])
                modes, begin = np.full(t.size, mode), state[0]
                if out.shape[1]:
                    state = out[:, -1]
                ends = np.append(t, t[-1:] + h[-1:] if t.size else begin)
                crossing = None
                may_cross = out.shape[1] == count and self.crossed is not None
                if (may_cross or self.changes) and not message:
                    crossing = watch.cross(ends, np.column_stack([last, columns]), mode)
                if crossing is not None:
                    t, h, columns, modes = _replace_last_step(crossing, t, h, columns, modes)
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
                message = _failure(state, end - start)
                if not message and crossing is None and not np.any(record[1]):
                    message = "the sign of a switching function cannot be determined"
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

    def _attempt_chunk(self, attempts: int, mode: int, state: np.ndarray, fixed: np.ndarray):
        """A chunk of attempts, up to the failure of an inner solver, and its reason."""
        try:
            return *self.columns(mode)(attempts, state, fixed), ""
        except SolverFailure:  # reports neither the step nor the states before it
            single, done = Kernel(self.single(mode)), []
        for _ in range(attempts):
            try:
                done.append(single(state, fixed))
            except SolverFailure as error:
                columns = [np.hstack(part) for part in zip(*done, strict=True)]
                empty = [np.zeros((state.size, 0)), np.zeros((single.function.numel_out(1), 0))]
                return *(columns or empty), f"a step failed: {error.reason}"
            state = done[-1][0].ravel()
        return *(np.hstack(part) for part in zip(*done, strict=True)), ""

    @staticmethod
    def _valid(watch: Watch, out, record, last, head: int, mode: int):
        """The valid attempts, the mode after them, and the reason to stop there, if any."""
        accepted = np.flatnonzero((record[3] > 0.5) & (record[1] > 0))
        if not accepted.size or not np.all(np.isfinite(out[:, accepted])):
            return out, record, mode, ""
        times = np.append(record[0, accepted], record[0, accepted[-1]] + record[1, accepted[-1]])
        columns = np.column_stack([last, out[head:, accepted]])
        valid, following, reason = watch.switch(times, columns, mode)
        if valid == accepted.size:
            return out, record, following, reason
        stop = accepted[valid]  # all attempts from here on are repeated in the new mode
        return out[:, :stop], record[:, :stop], following, reason


def _idle_at_the_end(
    function: ca.Function, memory: int, crossed: ca.Function | None
) -> ca.Function:
    """The attempt, skipped once the end is reached, so that the rest of a chunk costs nothing.

    It is also skipped beyond a switch, where the step across it has to be cut first.
    """
    state, fixed = ca.MX.sym("s", function.numel_in(0)), ca.MX.sym("f", function.numel_in(1))
    zeros = ca.MX.zeros(function.numel_out(1) - 1)
    idle = ca.Function("idle", [state, fixed], [state, ca.vertcat(state[0], zeros)])
    branch = ca.Function.if_else("attempt_or_idle", function, idle)
    active = state[0] < fixed[0]
    if crossed is not None:
        head = 2 + memory
        x = state[head : head + crossed.numel_in(1)]
        active = ca.logic_and(active, ca.mmax(crossed(state[0], x, fixed[2:])) <= 0)
    outputs = branch(active, state, fixed)
    return ca.Function("attempt", [state, fixed], list(outputs))


def _replace_last_step(crossing: Crossing, t, h, columns, modes):
    """Steps up to a crossing, and the steps that replace the one across it."""
    k = crossing.accepted
    return (
        np.append(t[:k], crossing.t),
        np.append(h[:k], crossing.h),
        np.column_stack([columns[:, :k], crossing.x]),
        np.append(modes[:k], crossing.mode),
    )


def _failure(state: np.ndarray, span: float) -> str:
    """Reason why a march of length ``span`` cannot continue from ``[t; h; …]``, or ``""``."""
    if not np.all(np.isfinite(state)):
        return "the state is no longer finite"
    if state[1] < SMALLEST_STEP * max(span, abs(state[0])):
        return f"the step length fell below {state[1]:.1e} s"
    return ""


def _finite(t: np.ndarray, h: np.ndarray, columns: np.ndarray):
    """The steps up to the last finite state."""
    finite = np.isfinite(columns).all(axis=0)
    count = finite.size if finite.all() else int(np.argmin(finite))
    return t[:count], h[:count], columns[:, :count]


def _collect(parts, start: float, last: np.ndarray, rejected: int) -> Steps:
    """The steps without their states."""
    empty = (np.zeros(0), np.zeros(0), np.zeros(0, dtype=int))
    times, lengths, mode = (np.concatenate(part) for part in zip(empty, *parts, strict=True))
    if not times.size:
        times = np.array([start])
    return Steps(times, lengths, last, np.ones(lengths.size, bool), mode, rejected)
