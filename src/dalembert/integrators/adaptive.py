"""Marching with steps whose length follows an estimate of the error."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from dalembert.integrators.base import Attempt
from dalembert.integrators.steps import Steps, Watch
from dalembert.symbolic.kernel import Kernel

ATTEMPTS = 64
SMALLEST_STEP = 1e-13


class AdaptiveMarch:
    """Attempted steps in chunks; the attempt itself keeps or refuses its step.

    Parameters
    ----------
    attempt_of : mode → Attempt
    """

    def __init__(self, attempt_of: Callable[[int], Attempt]):
        self.attempt_of = attempt_of
        self._chunks: dict[int, Kernel] = {}

    def prepare(self, mode: int) -> None:
        """Compile the attempts."""
        self._chunk(mode)

    def _chunk(self, mode: int) -> Kernel:
        if mode not in self._chunks:
            function = self.attempt_of(mode).function
            state = ca.MX.sym("s", function.numel_in(0))
            fixed = ca.MX.sym("f", function.numel_in(1))
            out = function.mapaccum(ATTEMPTS)(state, ca.repmat(fixed, 1, ATTEMPTS))
            self._chunks[mode] = Kernel(ca.Function("attempts", [state, fixed], list(out)))
        return self._chunks[mode]

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
        parts: list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]] = []
        head, rejected, message, interrupted = 2 + len(memory), 0, "", False
        last = x0.reshape(-1, 1)
        try:
            while state[0] < end:
                out, record = self._chunk(mode)(state, fixed)
                out, record, following, message = self._keep(watch, out, record, last, head, mode)
                taken = (record[3] > 0.5) & (record[1] > 0)
                rejected += int(np.sum((record[3] < 0.5) & (record[1] > 0)))
                modes = np.full(int(taken.sum()), mode)
                parts.append((record[0, taken], record[1, taken], out[head:, taken], modes))
                mode = following
                if message:
                    break
                if not out.shape[1]:
                    continue
                state = out[:, -1]
                if not np.all(np.isfinite(state)):
                    message = "the state is no longer finite"
                    break
                if state[1] < SMALLEST_STEP * max(1.0, abs(state[0])):
                    message = f"the step length fell below {state[1]:.1e} s"
                    break
                watch.progress((state[0] - start) / (end - start))
                t, h, columns, _ = parts[-1]
                if t.size and watch.stop(np.append(t, t[-1] + h[-1]), np.hstack([last, columns])):
                    break
                last = columns[:, -1:] if t.size else last
        except KeyboardInterrupt:
            message, interrupted = "interrupted", True
        steps = _collect(parts, start, x0, rejected)
        finite = np.all(np.isfinite(steps.x), axis=0)
        if not finite.all():
            steps = steps.cut(max(int(np.argmin(finite)) - 1, 0))
        steps.message, steps.interrupted = message, interrupted
        return steps

    @staticmethod
    def _keep(watch: Watch, out, record, last, head: int, mode: int):
        """The attempts to keep, the mode after them, and why to end there, if so."""
        taken = np.flatnonzero((record[3] > 0.5) & (record[1] > 0))
        if not taken.size or not np.all(np.isfinite(out[:, taken])):
            return out, record, mode, ""
        times = np.append(record[0, taken], record[0, taken[-1]] + record[1, taken[-1]])
        columns = np.hstack([last, out[head:, taken]])
        kept, following, reason = watch.switch(times, columns, mode)
        if kept == taken.size:
            return out, record, following, reason
        stop = taken[kept]  # everything from this attempt on is done again in the new mode
        return out[:, :stop], record[:, :stop], following, reason


def _collect(parts, start: float, x0: np.ndarray, rejected: int) -> Steps:
    columns = [x0.reshape(-1, 1), *(part[2] for part in parts)]
    times = np.concatenate([part[0] for part in parts]) if parts else np.zeros(0)
    lengths = np.concatenate([part[1] for part in parts]) if parts else np.zeros(0)
    mode = np.concatenate([part[3] for part in parts]) if parts else np.zeros(0, dtype=int)
    if not times.size:
        times = np.array([start])
    corrected = np.ones(lengths.size, bool)
    return Steps(times, lengths, np.hstack(columns), corrected, mode, rejected)
