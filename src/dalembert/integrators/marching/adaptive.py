"""Marching with adaptive step size."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from dalembert.errors import SolverFailure
from dalembert.integrators.base import Attempt
from dalembert.integrators.marching.loop import StepSource, Stretch, take_steps
from dalembert.integrators.marching.march import FixedMarch
from dalembert.integrators.marching.method_choice import MethodChoice
from dalembert.integrators.marching.steps import Crossing, Samples, Steps, Watch
from dalembert.symbolic.evaluation.backends import Backend, VirtualMachine
from dalembert.symbolic.evaluation.columns import Columns
from dalembert.symbolic.evaluation.kernel import Kernel

ATTEMPTS = 64
"""Number of attempts per call."""
SMALLEST_STEP = 1e-13
"""Lower limit of the step, relative to the length of the run and to |t| [-]."""


RESTART = 1e-4
"""First step after a sample, relative to the run, of methods that lose their memory."""


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
        samples: Samples | None = None,
    ) -> Steps:
        """March from ``start`` to ``end``; stops when the step length collapses."""
        numbers = start, end, first_step, longest
        attempts = Attempts(self, numbers, x0, p, mode, watch.choice, samples)
        recorder = watch.recorder(x0)
        steps = take_steps(attempts, recorder, watch)
        steps.x = recorder.states(None if self.fixed is None else self.fixed.again(steps, p))
        return steps

    def advance(self, attempts: int, mode: int, state: np.ndarray, fixed: np.ndarray):
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


class Attempts(StepSource):
    """Attempted steps, of which the accepted ones form the march.

    Parameters
    ----------
    march : AdaptiveMarch
    numbers : start, end, first step and longest step [s]
    x0, p, mode : first state, parameters and mode
    choice : choice between two methods; None for a single method
    samples : transitions at fixed times, between which attempts end there
    """

    def __init__(
        self,
        march: AdaptiveMarch,
        numbers: tuple[float, float, float, float],
        x0: np.ndarray,
        p: np.ndarray,
        mode: int,
        choice: MethodChoice | None,
        samples: Samples | None = None,
    ):
        self.march, self.choice, self.mode = march, choice, mode
        self.samples, self.sample = samples, 0
        self.start, self.end, first_step, longest = numbers
        self.memory = march.attempt_of(mode).memory
        self.state = np.concatenate([[self.start, first_step], self.memory, x0])
        self.fixed = np.concatenate([[self._stop, longest], p])
        self.states = self.record = np.zeros((0, 0))
        self.complete = True

    @property
    def pending(self) -> bool:
        return bool(self.state[0] < self.end)

    @property
    def _stop(self) -> float:
        """Time of the next sample, or of the end [s]."""
        if self.samples is None or self.sample == self.samples.times.size:
            return self.end
        return float(self.samples.times[self.sample])

    @property
    def progress(self) -> float:
        return float((self.state[0] - self.start) / (self.end - self.start))

    @property
    def _accepted(self) -> np.ndarray:
        """Indices of the accepted attempts; attempts of zero length are idle."""
        return np.flatnonzero((self.record[3] > 0.5) & (self.record[1] > 0))

    def take(self, time: float, x: np.ndarray) -> tuple[Stretch, str]:
        self.sampling = bool(self.state[0] >= self._stop)
        if self.sampling:
            return self._take_sample(time, x)
        count = self.choice.attempts(self.mode) if self.choice else ATTEMPTS
        attempts = self.march.advance(count, self.mode, self.state, self.fixed)
        self.states, self.record, failure = attempts
        self.complete, accepted = True, self._accepted
        columns = self.states[2 + len(self.memory) :, accepted]
        corrected, mode = np.ones(accepted.size, bool), np.full(accepted.size, self.mode)
        t, h = self.record[:2, accepted]
        return Stretch.of(self.state[0], x, columns, t, h, corrected, mode), failure

    def _take_sample(self, time: float, x: np.ndarray) -> tuple[Stretch, str]:
        """The transition at the current time."""
        assert self.samples is not None and self.march.fixed is not None
        mode = self.samples.mode(self.mode, int(self.samples.due[self.sample]))
        step = np.array([time]), np.zeros(1), np.ones(1, bool)
        states, failure, _ = self.march.fixed.advance(mode, x, step, self.fixed[2:])
        self.sample += 1
        self.fixed[0] = self._stop
        return Stretch.of(time, x, states, *step, np.array([mode])), failure

    def _continue(self, x: np.ndarray) -> None:
        """Continue after a sample, with the longest of the last steps."""
        lengths = self.record[1, self._accepted[-2:]] if self.record.size else np.zeros(0)
        length = max(self.state[1], *lengths) if lengths.size else self.state[1]
        march = self.march.fixed
        if march is not None and march.step_of(self.mode).begin is not None:
            length = min(length, RESTART * (self.end - self.start))
        self._restart(self.state[0], min(length, self.fixed[1]), x)

    def reject(self, accepted: int) -> None:
        stop = int(np.append(self._accepted, self.record.shape[1])[accepted])
        self.complete = stop == self.record.shape[1]
        self.states, self.record = self.states[:, :stop], self.record[:, :stop]

    def may_cross(self, reason: str) -> bool:
        detects = self.complete and self.march.crossed is not None
        return (detects or self.march.changes) and not reason

    def settle(
        self, stretch: Stretch, following: int, crossing: Crossing | None, failure: str
    ) -> str:
        if self.sampling:
            self._continue(stretch.x[:, -1])
            return failure
        self.rejected += int(np.sum((self.record[3] < 0.5) & (self.record[1] > 0)))
        if self.record.shape[1]:
            self.state = self.states[:, -1]
        if crossing is not None:
            self._restart(stretch.ends[-1], crossing.following, stretch.x[:, -1])
        elif self.choice and following == self.mode:
            following, length, failure = self.choice.after(self.record, self.mode, failure)
            if length is not None:
                self._restart(self.state[0], length, self.state[2 + len(self.memory) :])
        self.mode = following
        if failure or not self.record.shape[1]:
            return failure
        failure = _failure(self.state, self.end - self.start)
        if not failure and crossing is None and not np.any(self.record[1]):
            failure = "the sign of a switching function cannot be determined"
        return failure

    def _restart(self, time: float, length: float, x: np.ndarray) -> None:
        """Forget the memory of the step size controller."""
        self.state = np.concatenate([[time, length], self.memory, x])


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


def _failure(state: np.ndarray, span: float) -> str:
    """Reason why a march of length ``span`` cannot continue from ``[t; h; …]``, or ``""``."""
    if not np.all(np.isfinite(state)):
        return "the state is no longer finite"
    if state[1] < SMALLEST_STEP * max(span, abs(state[0])):
        return f"the step length fell below {state[1]:.1e} s"
    return ""
