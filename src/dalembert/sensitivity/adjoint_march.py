"""Adjoint gradients through time: the steps that were taken, backwards.

The weight of the state is carried back, ``x̄_k = (∂x_{k+1}/∂x_k)ᵀ x̄_{k+1} + (what the response sees
at k)``, and the weight of the parameters collected on the way to the initial state.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.integrators.march import CHUNK, flagged
from dalembert.integrators.steps import run_length
from dalembert.sensitivity.marched_sample import MarchedSample
from dalembert.symbolic.kernel import Kernel


class AdjointMarch(MarchedSample):
    """Gradient of one sampled response; its cost does not grow with the parameters."""

    def gradient(self) -> np.ndarray:
        """(np,) gradient by one backward march."""
        _, seen, p_bar = self.kernel.mapped(
            lambda variant: self.measured(variant).adjoint,
            self.modes,
            self.motion.time,
            self.states,
            self.p,
            self.sample.weights.reshape(1, -1),
        )
        x_bar = np.vstack([seen, np.zeros((self.size - seen.shape[0], seen.shape[1]))])
        injected, more = self._inject(x_bar)
        first, marched = self._march_back(injected)
        return p_bar.sum(axis=1) + more + marched + self._through_start(first)

    def _inject(self, x_bar: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the sampled states moved to the step ends they branch from."""
        steps, k, length = self.steps, self.branches.index, self.branches.length
        injected, p_bar = np.zeros((self.size, steps.count + 1)), np.zeros(self.p.size)
        if not steps.count:
            return x_bar.sum(axis=1, keepdims=True), p_bar
        begins, ends = length == 0, self.branches.ends_of(steps)
        np.add.at(injected.T, k[begins], x_bar[:, begins].T)
        np.add.at(injected.T, k[ends] + 1, x_bar[:, ends].T)
        inside = np.flatnonzero(~begins & ~ends)
        for mode in np.unique(steps.mode[k[inside]]):
            part = inside[steps.mode[k[inside]] == mode]
            back, more = self.kernel.over(self.step_of(mode).adjoint, part.size)(
                steps.t[k[part]],
                length[part],
                steps.x[:, k[part]],
                np.tile(self.p[:, None], part.size),
                x_bar[:, part],
            )
            np.add.at(injected.T, k[part], back.T)
            p_bar += more.sum(axis=1)
        return injected, p_bar

    def _march_back(self, injected: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        n, steps = self.size, self.steps
        carried = np.concatenate([injected[:, -1], np.zeros(self.p.size)])
        stop = steps.count
        while stop > 0:
            mode = int(steps.mode[stop - 1])
            count = run_length(steps.mode[:stop][::-1], 0, CHUNK)
            part = np.arange(stop - 1, stop - count - 1, -1)
            (carried,) = self._backward(count, mode)(
                carried,
                steps.t[part],
                steps.h[part],
                steps.corrected[part],
                steps.x[:, part],
                injected[:, part],
                self.p,
            )
            carried, stop = carried.ravel(), stop - count
        return carried[:n], carried[n:]

    def _backward(self, count: int, mode: int) -> Kernel:
        """``count`` backward steps in one call."""
        step = self.kernel.backend.repeated(self._backward_step(mode), count)

        def make() -> Kernel:
            n, m = self.size, self.p.size
            single = step.mapaccum(count)
            carried, p = ca.MX.sym("c", n + m), ca.MX.sym("p", m)
            t, h, flag = (ca.MX.sym(s, 1, count) for s in ("t", "h", "flag"))
            x, inject = ca.MX.sym("x", n, count), ca.MX.sym("i", n, count)
            out = single(carried, t, h, flag, x, inject, ca.repmat(p, 1, count))
            return Kernel(
                ca.Function("backward", [carried, t, h, flag, x, inject, p], [out[:, -1]])
            )

        return self.model.compiled(("backward", step, count), make)

    def _backward_step(self, mode: int) -> ca.Function:
        def make() -> ca.Function:
            n, m = self.size, self.p.size
            step = self.step_of(mode)
            call, symbolic = flagged(step, self.kernel.fixed.period, lambda step: step.adjoint)
            kind: Any = ca.SX if symbolic else ca.MX
            carried, x, inject = kind.sym("c", n + m), kind.sym("x", n), kind.sym("i", n)
            t, h, flag, p = kind.sym("t"), kind.sym("h"), kind.sym("flag"), kind.sym("p", m)
            x_bar, p_bar = call(flag, t, h, x, p, carried[:n])
            following = ca.vertcat(x_bar + inject, carried[n:] + p_bar)
            inputs = [carried, t, h, flag, x, inject, p]
            return ca.Function("backward_step", inputs, [following])

        return self.model.compiled(("backward_step", self.kernel, mode), make)

    def _through_start(self, x_bar: np.ndarray) -> np.ndarray:
        """Weight of the parameters through memory and the assembled initial state."""
        start, p = float(self.steps.t[0]), self.p
        first = self.first_step
        size, gradient = first.state_size, np.zeros(p.size)
        weight = x_bar[:size]
        if first.begin is not None:
            x0 = self.steps.x[:size, 0]
            memory = first.begin(start, x0, p)
            _, back, p_bar = first.begin.reverse(1)(start, x0, p, memory, x_bar[size:])
            weight, gradient = weight + back.full().ravel(), p_bar.full().ravel()
        y, v = self.assembled()
        _, y_bar, v_bar, p_bar = self.kernel.start.adjoint(start, y, v, p, weight)
        parts = self.model.initial_state.adjoint(start, y, p, y_bar, v_bar)
        return gradient + p_bar.full().ravel() + parts[2].full().ravel()
