"""Gradients through time: exact derivatives of the steps that were taken.

Direct differentiation carries ``∂x/∂p`` along with the steps. The adjoint carries the weight of
the state backwards, ``x̄_k = (∂x_{k+1}/∂x_k)ᵀ x̄_{k+1} + (what the response sees at k)``, and
collects the weight of the parameters on its way to the initial state.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics_kernel import DynamicsKernel, Variant
from dalembert.integrators.step import Step
from dalembert.integrators.steps import Steps, run_length
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.implicit import ImplicitFunction
from dalembert.symbolic.kernel import Kernel

CHUNK = 500


class MarchGradient:
    """Gradient of one sampled response of a dynamic run."""

    def __init__(self, sample: Sample):
        self.sample, self.motion = sample, sample.motion
        record = self.motion.record
        self.kernel: DynamicsKernel = record.kernel
        self.steps: Steps = record.steps
        self.branches = record.branches
        self.model = self.motion.model
        self.p = self.motion.parameters
        self.states = self.kernel.branch_states(self.steps, self.branches, self.p)
        self.modes = self.kernel.modes(self.steps, self.branches)
        self.size = self.steps.x.shape[0]

    def step_of(self, mode: int) -> Step:
        return self.kernel.variants[mode].step

    def measured(self, variant: Variant) -> ImplicitFunction:
        """``(t, x, p) → measure``, accelerations and multipliers included."""
        measure = self.sample.measure
        return self.model.compiled(
            ("measured", variant, measure),
            lambda: variant.measured([self.model.at_ground(measure.sx)]),
        )

    # adjoint -------------------------------------------------------------------------
    def adjoint(self) -> np.ndarray:
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
            back, more = Kernel(self.step_of(mode).adjoint.map(part.size))(
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

        def make() -> Kernel:
            n, m = self.size, self.p.size
            single = self._backward_step(mode).mapaccum(count)
            carried, p = ca.MX.sym("c", n + m), ca.MX.sym("p", m)
            t, h, flag = (ca.MX.sym(s, 1, count) for s in ("t", "h", "flag"))
            x, inject = ca.MX.sym("x", n, count), ca.MX.sym("i", n, count)
            out = single(carried, t, h, flag, x, inject, ca.repmat(p, 1, count))
            return Kernel(
                ca.Function("backward", [carried, t, h, flag, x, inject, p], [out[:, -1]])
            )

        return self.model.compiled(("backward", self.kernel, count, mode), make)

    def _sometimes(self, step: Step) -> bool:
        """Whether the correction follows some steps only."""
        return self.kernel.fixed.period > 1 and step.corrects

    def _backward_step(self, mode: int) -> ca.Function:
        def make() -> ca.Function:
            n, m = self.size, self.p.size
            step = self.step_of(mode)
            symbolic = step.adjoint.is_a("SXFunction") and not self._sometimes(step)
            kind: Any = ca.SX if symbolic else ca.MX
            carried, x, inject = kind.sym("c", n + m), kind.sym("x", n), kind.sym("i", n)
            t, h, flag, p = kind.sym("t"), kind.sym("h"), kind.sym("flag"), kind.sym("p", m)
            if self._sometimes(step):
                branch = ca.Function.if_else("branch", step.adjoint, step.plain.adjoint)
                x_bar, p_bar = branch(flag, t, h, x, p, carried[:n])
            else:
                x_bar, p_bar = step.adjoint(t, h, x, p, carried[:n])
            following = ca.vertcat(x_bar + inject, carried[n:] + p_bar)
            inputs = [carried, t, h, flag, x, inject, p]
            return ca.Function("backward_step", inputs, [following])

        return self.model.compiled(("backward_step", self.kernel, mode), make)

    def _through_start(self, x_bar: np.ndarray) -> np.ndarray:
        """Weight of the parameters through memory and the assembled initial state."""
        start, p = float(self.steps.t[0]), self.p
        first = self.kernel.variants[self.steps.mode[0] if self.steps.count else -1].step
        size, gradient = first.state_size, np.zeros(p.size)
        weight = x_bar[:size]
        if first.begin is not None:
            x0 = self.steps.x[:size, 0]
            memory = first.begin(start, x0, p)
            _, back, p_bar = first.begin.reverse(1)(start, x0, p, memory, x_bar[size:])
            weight, gradient = weight + back.full().ravel(), p_bar.full().ravel()
        y, v = self._assembled()
        _, y_bar, v_bar, p_bar = self.kernel.start.adjoint(start, y, v, p, weight)
        parts = self.model.initial_state.adjoint(start, y, p, y_bar, v_bar)
        return gradient + p_bar.full().ravel() + parts[2].full().ravel()

    def _assembled(self) -> tuple[np.ndarray, np.ndarray]:
        """Initial poses and speeds of the bodies."""
        state = self.model.assemble(self.p, float(self.steps.t[0]))
        return state.y, state.v

    # direct --------------------------------------------------------------------------
    def direct(self, changes: list[np.ndarray]) -> np.ndarray:
        """(np,) gradient from ``∂x/∂p`` at every step, as ``march_tangents`` gives it."""
        m, steps = self.p.size, self.steps
        k, length = self.branches.index, self.branches.length
        ends = self.branches.ends_of(steps)
        gradient = np.zeros(m)
        for j in np.flatnonzero(self.sample.weights):
            variant = self.kernel.variants[self.modes[j]]
            dx = changes[k[j]]
            if ends[j]:
                dx = changes[k[j] + 1]
            elif length[j] > 0:
                stepped = self.step_of(steps.mode[k[j]]).tangent
                dx = stepped.map(m)(
                    steps.t[k[j]], length[j], steps.x[:, k[j]], self.p, dx, np.eye(m)
                ).full()
            size = variant.step.state_size
            rates = self.measured(variant).tangent.map(m)(
                self.motion.time[j], self.states[:size, j], self.p, 0, dx[:size], np.eye(m)
            )
            gradient += self.sample.weights[j] * rates.full().ravel()
        return gradient

    def march_tangents(self) -> list[np.ndarray]:
        """``∂x_k/∂p`` (n, np) at the beginning of every step and at the end."""
        m, steps = self.p.size, self.steps
        found = [self._tangent_start()]
        begin = 0
        while begin < steps.count:
            count = run_length(steps.mode, begin, CHUNK)
            part = slice(begin, begin + count)
            out = self._forward(count, int(steps.mode[begin]))(
                found[-1],
                steps.t[part],
                steps.h[part],
                steps.corrected[part],
                steps.x[:, part],
                self.p,
            ).full()
            found += [out[:, j * m : (j + 1) * m] for j in range(count)]
            begin += count
        return found

    def _tangent_start(self) -> np.ndarray:
        m, p, t = self.p.size, self.p, float(self.steps.t[0])
        y, v = self._assembled()
        n, unit = y.size, np.eye(m)
        dy, dv = self.model.initial_state.tangent.map(m)(t, y, p, 0, np.zeros((n, m)), unit)
        dx = self.kernel.start.tangent.map(m)(t, y, v, p, 0, dy, dv, unit).full()
        first = self.kernel.variants[self.steps.mode[0] if self.steps.count else -1].step
        if first.begin is None:
            return dx
        x0 = self.steps.x[: first.state_size, 0]
        memory = first.begin(t, x0, p)
        more = first.begin.forward(m)(t, x0, p, memory, np.zeros((1, m)), dx, unit)
        return np.vstack([dx, more.full()])

    def _forward(self, count: int, mode: int) -> ca.Function:
        """Tangents of ``count`` steps for all parameters in one call."""

        def make() -> ca.Function:
            n, m = self.size, self.p.size
            dx, p = ca.MX.sym("dx", n, m), ca.MX.sym("p", m)
            t, h, flag = (ca.MX.sym(s) for s in ("t", "h", "flag"))
            x, step = ca.MX.sym("x", n), self.step_of(mode)
            tangent, flags = step.tangent, []
            if self._sometimes(step):
                tangent = ca.Function.if_else("branch", tangent, step.plain.tangent)
                flags = [flag]
            unit = ca.DM.eye(m)
            one = [tangent(*flags, t, h, x, p, dx[:, i], unit[:, i]) for i in range(m)]
            following = ca.horzcat(*one) if one else ca.MX(n, 0)
            single = ca.Function("forward_step", [dx, t, h, flag, x, p], [following])
            ts, hs, fs = (ca.MX.sym(s, 1, count) for s in ("t", "h", "flag"))
            xs = ca.MX.sym("xs", n, count)
            out = single.mapaccum(count)(dx, ts, hs, fs, xs, ca.repmat(p, 1, count))
            return ca.Function("forward", [dx, ts, hs, fs, xs, p], [out])

        return self.model.compiled(("forward", self.kernel, count, mode), make)
