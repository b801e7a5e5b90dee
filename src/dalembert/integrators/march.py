"""Marching through time in chunks that run inside CasADi; Python sees chunks only."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.integrators.step import ExplicitStep
from dalembert.symbolic.kernel import Kernel

CHUNK = 500
ATTEMPTS = 64
SMALLEST_STEP = 1e-13


@dataclass
class Steps:
    """Steps taken: ``x[:, k]`` at ``t[k]``, then a step of length ``h[k]``.

    ``corrected[k]`` tells whether the step ended with the correction. The last column of ``x`` is
    the end of the last step. ``message`` is empty when the end was reached.
    """

    t: np.ndarray
    h: np.ndarray
    x: np.ndarray
    corrected: np.ndarray
    rejected: int = 0
    message: str = ""
    interrupted: bool = False

    @property
    def count(self) -> int:
        return self.h.size

    @property
    def end(self) -> float:
        return float(self.t[-1] + self.h[-1]) if self.count else float(self.t[0])

    def cut(self, count: int, message: str = "") -> Steps:
        """The first ``count`` steps."""
        t = self.t[: max(count, 1)] if count else self.t[:1]
        return Steps(
            t,
            self.h[:count],
            self.x[:, : count + 1],
            self.corrected[:count],
            self.rejected,
            message or self.message,
            self.interrupted,
        )


@dataclass
class Watch:
    """What to do after each chunk of states ``(t, x)``: report progress; stop when asked."""

    progress: Callable[[float], None] = lambda fraction: None
    stop: Callable[[np.ndarray, np.ndarray], bool] = lambda times, states: False


class FixedMarch:
    """Steps of given lengths.

    Parameters
    ----------
    step : ExplicitStep
    period : the correction follows every ``period``-th step
    """

    def __init__(self, step: ExplicitStep, period: int = 1):
        self.step, self.period = step, period
        self._chunks: dict[int, Kernel] = {}

    def _chunk(self, count: int) -> Kernel:
        if count not in self._chunks:
            self._chunks[count] = Kernel(_map_steps(self._single(), count, self.step))
        return self._chunks[count]

    def prepare(self, count: int) -> None:
        """Compile what ``count`` steps need."""
        if count >= CHUNK:
            self._chunk(CHUNK)
        if count % CHUNK:
            self._chunk(count % CHUNK)

    def _single(self) -> ca.Function:
        """``(x, t, h, flag, p) → x``; the flag says whether this step is corrected."""
        n, m = self.step.size, self.step.parameter_count
        if self.period == 1 or self.step.correction is None:
            x, p = ca.SX.sym("x", n), ca.SX.sym("p", m)
            t, h, flag = ca.SX.sym("t"), ca.SX.sym("h"), ca.SX.sym("flag")
            return ca.Function("single", [x, t, h, flag, p], [self.step.function(t, h, x, p)])
        return self._branching(n, m)

    def _branching(self, n: int, m: int) -> ca.Function:
        """The step with or without its correction, of which only one is evaluated."""
        x, p = ca.MX.sym("x", n), ca.MX.sym("p", m)
        t, h, flag = ca.MX.sym("t"), ca.MX.sym("h"), ca.MX.sym("flag")
        branch = ca.Function.if_else("branch", self.step.function, self.step.uncorrected)
        return ca.Function("single", [x, t, h, flag, p], [branch(flag, t, h, x, p)])

    def run(
        self, times: np.ndarray, x0: np.ndarray, p: np.ndarray, watch: Watch | None = None
    ) -> Steps:
        """March over the grid ``times``; stops at the first state that is not finite."""
        h = np.diff(times)
        number = np.arange(1, h.size + 1)
        corrected = (number % self.period == 0) | (number == h.size)
        return self._march(times, h, corrected, x0, p, watch or Watch())

    def repeat(self, steps: Steps, x0: np.ndarray, p: np.ndarray) -> Steps:
        """The steps of an earlier march from another state with other parameters."""
        return self._march(steps.t, steps.h, steps.corrected, x0, p, Watch())

    def _march(self, times, h, corrected, x0, p, watch: Watch) -> Steps:
        columns, done, message, interrupted = [x0.reshape(-1, 1)], 0, "", False
        try:
            while done < h.size:
                count = min(CHUNK, h.size - done)
                part = slice(done, done + count)
                (out,) = self._chunk(count)(
                    columns[-1][:, -1], times[part], h[part], corrected[part], p
                )
                good = np.all(np.isfinite(out), axis=0)
                valid = count if good.all() else int(np.argmin(good))
                columns.append(out[:, :valid])
                done += valid
                if valid < count:
                    message = "the state is no longer finite"
                    break
                watch.progress(done / h.size)
                ends = np.append(times[done - valid : done], times[done - 1] + h[done - 1])
                if watch.stop(ends, np.hstack([columns[-2][:, -1:], out])):
                    break
        except KeyboardInterrupt:
            message, interrupted = "interrupted", True
        x = np.hstack(columns)
        return Steps(
            times[: max(done, 1)],
            h[:done],
            x,
            corrected[:done],
            message=message,
            interrupted=interrupted,
        )


def _map_steps(single: ca.Function, count: int, step: ExplicitStep) -> ca.Function:
    """One function for a chunk: repeats the parameters inside, so that NumPy converts once."""
    x = ca.MX.sym("x", step.size)
    t, h, flag = (ca.MX.sym(n, 1, count) for n in ("t", "h", "flag"))
    p = ca.MX.sym("p", step.parameter_count)
    columns = single.mapaccum(count)(x, t, h, flag, ca.repmat(p, 1, count))
    return ca.Function("chunk", [x, t, h, flag, p], [columns])


class AdaptiveMarch:
    """Steps whose length is controlled by an embedded error estimate.

    An attempt is one function: it computes the step and its error, keeps or refuses it, and
    proposes the next length by a PI controller (Gustafsson 1991).
    """

    def __init__(self, step: ExplicitStep, rtol: float, atol: float, controlled: int):
        self.step, self.rtol, self.atol, self.controlled = step, rtol, atol, controlled
        self._chunk_function: Kernel | None = None

    def prepare(self) -> None:
        """Compile the attempts."""
        self._chunk()

    def _attempt(self) -> ca.Function:
        """``([t; h; last error; x], [end; longest; p]) → next, [t; h; error; accepted]``."""
        n, m = self.step.size, self.step.parameter_count
        tableau = self.step.tableau
        state, fixed = ca.SX.sym("s", 3 + n), ca.SX.sym("f", 2 + m)
        t, proposed, last, x = state[0], state[1], state[2], state[3:]
        end, longest, p = fixed[0], fixed[1], fixed[2:]
        h = ca.fmin(ca.fmin(proposed, longest), end - t)
        _, slopes = self.step.stages(t, h, x, p)
        new = self.step.advance(h, x, slopes)
        weights = tableau.b_error or ()
        error = h * sum((w * k for w, k in zip(weights, slopes, strict=True) if w), ca.SX(0))
        scale = self.atol + self.rtol * ca.fmax(ca.fabs(x), ca.fabs(new))
        ratio = ca.mmax((ca.fabs(error) / scale)[: self.controlled])
        finite = ca.if_else(ratio <= 1e30, ratio, 1e30)  # false for NaN as well
        accepted = finite <= 1
        q = tableau.order
        growth = 0.9 * ca.fmax(finite, 1e-10) ** (-0.7 / q) * ca.fmax(last, 1e-10) ** (0.4 / q)
        factor = ca.if_else(
            accepted,
            ca.fmin(5, ca.fmax(0.2, growth)),
            ca.fmax(0.1, 0.9 * finite ** (-1 / q)),
        )
        corrected = self.step.correct(t + h, new, p)
        arrived = end - (t + h) <= 1e-12 * ca.fmax(1, ca.fabs(end))
        t_new = ca.if_else(accepted, ca.if_else(arrived, end, t + h), t)
        # the clipped last step must not make the controller believe in short steps
        h_new = ca.if_else(ca.logic_and(accepted, h < proposed), proposed, h * factor)
        following = ca.vertcat(
            t_new,
            h_new,
            ca.if_else(accepted, ca.fmax(finite, 1e-4), last),
            ca.if_else(accepted, corrected, x),
        )
        record = ca.vertcat(t, h, finite, accepted)
        return ca.Function("attempt", [state, fixed], [following, record], {"cse": True})

    def _chunk(self) -> Kernel:
        if self._chunk_function is None:
            mapped = self._attempt().mapaccum(ATTEMPTS)
            state = ca.MX.sym("s", 3 + self.step.size)
            fixed = ca.MX.sym("f", 2 + self.step.parameter_count)
            out = mapped(state, ca.repmat(fixed, 1, ATTEMPTS))
            self._chunk_function = Kernel(ca.Function("attempts", [state, fixed], list(out)))
        return self._chunk_function

    def run(
        self,
        start: float,
        end: float,
        x0: np.ndarray,
        p: np.ndarray,
        first_step: float,
        longest: float,
        watch: Watch | None = None,
    ) -> Steps:
        """March from ``start`` to ``end``; stops when the step length collapses."""
        watch = watch or Watch()
        state = np.concatenate([[start, first_step, 1.0], x0])
        fixed = np.concatenate([[end, longest], p])
        t, h, columns, rejected, message, interrupted = [], [], [x0.reshape(-1, 1)], 0, "", False
        try:
            while state[0] < end:
                out, record = self._chunk()(state, fixed)
                taken = (record[3] > 0.5) & (record[1] > 0)
                rejected += int(np.sum((record[3] < 0.5) & (record[1] > 0)))
                t.append(record[0, taken])
                h.append(record[1, taken])
                columns.append(out[3:, taken])
                state = out[:, -1]
                if not np.all(np.isfinite(state)):
                    message = "the state is no longer finite"
                    break
                if state[1] < SMALLEST_STEP * max(1.0, abs(state[0])):
                    message = f"the step length fell below {state[1]:.1e} s"
                    break
                watch.progress((state[0] - start) / (end - start))
                ends = np.append(t[-1], t[-1][-1:] + h[-1][-1:])
                if watch.stop(ends, np.hstack([columns[-2][:, -1:], columns[-1]])):
                    break
        except KeyboardInterrupt:
            message, interrupted = "interrupted", True
        steps = self._collect(t, h, columns, start, rejected)
        finite = np.all(np.isfinite(steps.x), axis=0)
        if not finite.all():
            steps = steps.cut(max(int(np.argmin(finite)) - 1, 0))
        steps.message, steps.interrupted = message, interrupted
        return steps

    @staticmethod
    def _collect(t, h, columns, start: float, rejected: int) -> Steps:
        times = np.concatenate(t) if t else np.zeros(0)
        lengths = np.concatenate(h) if h else np.zeros(0)
        if not times.size:
            times = np.array([start])
        return Steps(times, lengths, np.hstack(columns), np.ones(lengths.size, bool), rejected)
