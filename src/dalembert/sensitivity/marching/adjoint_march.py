"""Adjoint gradients of dynamics: backward march over the recorded steps, in chunks."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.integrators.marching.march import branches, with_flag
from dalembert.integrators.step import Step
from dalembert.sensitivity.marching.marched_sample import MarchedSample, memory_adjoint
from dalembert.sensitivity.marching.walk import BackwardWalk
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.evaluation.prelude import Prelude
from dalembert.symbolic.once import once


class AdjointMarch(MarchedSample, BackwardWalk[np.ndarray]):
    """Gradient of one sampled response, at a cost independent of the number of parameters."""

    def gradient(self) -> np.ndarray:
        """(np,) gradient by one backward march."""
        self.p_bar = np.zeros(self.p.size)
        self.backwards()
        return self.p_bar

    def depart(self) -> np.ndarray:
        """``[x̄; p̄]`` at the end."""
        return np.append(self._injected(self.count, self.count)[:, 0], np.zeros(self.p.size))

    def pull(self, begin: int, end: int, weights: np.ndarray) -> np.ndarray:
        injected = self._injected(begin, end - 1)[:, ::-1]
        steps = *self.step_data(begin, end, back=True), injected
        return self._backward(begin, end, weights, steps)

    def pull_start(self, weights: np.ndarray) -> None:
        self.p_bar += weights[self.size :] + self._through_start(weights[: self.size])

    def _injected(self, first: int, last: int) -> np.ndarray:
        """(n, last − first + 1) weights of the states with these numbers in the response.

        Weights of outputs inside steps are pulled back to the start of the step; the resulting
        weights of the parameters are added to ``p_bar``.
        """
        injected = np.zeros((self.size, last - first + 1))
        for instant in self.instants:
            if first <= instant.number <= last:
                injected[:, instant.number - first] += instant.x
                self.p_bar += instant.p
        chosen = self.active_outputs(first, last)
        if not chosen.size:
            return injected
        states = self.states_at(chosen)
        x_bar = np.zeros((self.size, chosen.size))
        _, state_bar, more = self.kernel.mapped(
            lambda variant: self.measured(variant).adjoint,
            self.modes[chosen],
            self.motion.time[chosen],
            states,
            self.p,
            self.sample.weights[None, chosen],
        )
        x_bar[: state_bar.shape[0]] = state_bar
        self.p_bar += more.sum(axis=1)
        if self.moving is not None:
            rates, slopes = self.output_shifts(chosen)
            self.p_bar[: slopes.shape[1]] += (rates * x_bar).sum(axis=0) @ slopes
        for mode, part in self.partial_steps(chosen):
            x_bar[:, part], more = self.kernel.over(self.step_of(mode).adjoint, part.size)(
                *self.partial_step_data(chosen[part]), x_bar[:, part]
            )
            self.p_bar += more.sum(axis=1)
        np.add.at(injected.T, self.number[chosen] - first, x_bar.T)
        return injected

    def _backward(self, begin: int, end: int, carried: np.ndarray, steps) -> np.ndarray:
        """``[x̄; p̄]`` pulled back through the steps between two states in one call."""
        n, p, count, mode = self.size, self.p, end - begin, int(self.steps.mode[begin])
        if self.kernel.fixed.at_once(mode):
            return _backward_chunk(self.step_of(mode), count)(carried, *steps, p)[0].ravel()
        compiled = self.kernel.steps(mode).compiled
        prelude, single = backward_step(self.kernel, mode, compiled)
        first = np.append(carried[:n], np.zeros(prelude.rate_count))
        values = prelude.values(p).full()
        columns = self.kernel.marched(single, (6,))
        columns.announce(end)
        (out,) = columns(count, first, *steps, values)
        last = out[:, -1]
        if self.moving is not None:
            weights = np.column_stack([first, out[:, :-1]])[:n, ::-1]
            more = self.moving.pull(begin, end, weights)
            self.p_bar[: more.size] += more
        return np.append(last[:n], carried[n:] + prelude.adjoint(p, last[n:]).full().ravel())

    def _through_start(self, x_bar: np.ndarray) -> np.ndarray:
        """Weights of the parameters through the memory and the assembled initial state."""
        start, p = float(self.steps.t[0]), self.p
        first = self.first_step
        size, gradient = first.state_size, np.zeros(p.size)
        weight = x_bar[:size]
        if first.begin is not None:
            x0 = self.steps.x[:size, 0]
            memory = first.begin(start, x0, p)
            adjoint = memory_adjoint(first)
            _, back, p_bar = adjoint(start, x0, p, memory, x_bar[size:])
            weight, gradient = weight + back.full().ravel(), p_bar.full().ravel()
        y, v = self.assembled()
        _, y_bar, v_bar, p_bar = self.kernel.start.adjoint(start, y, v, p, weight)
        parts = self.model.initial_state.adjoint(start, y, p, y_bar, v_bar)
        return gradient + p_bar.full().ravel() + parts[2].full().ravel()


@once
def _backward_chunk(step: Step, count: int) -> Kernel:
    """Kernel of ``[x̄; p̄]`` pulled back through a chunk of equal steps."""
    n, m = step.size, step.parameter_count
    carried, p = ca.MX.sym("c", n + m), ca.MX.sym("p", m)
    t, h, flag = (ca.MX.sym(s, 1, count) for s in ("t", "h", "flag"))
    x, inject = ca.MX.sym("x", n, count), ca.MX.sym("i", n, count)
    forwards = list(reversed(range(count)))
    weights = ca.horzcat(inject[:, forwards[1:]], carried[:n])
    steps = (x[:, -1], t[:, forwards], h[:, forwards], flag[:, forwards], p)
    x_bar, p_bar = step.chunk_adjoint(count)(*steps, weights)
    following = ca.vertcat(x_bar + inject[:, -1], carried[n:] + p_bar)
    return Kernel(ca.Function("backward", [carried, t, h, flag, x, inject, p], [following]))


@once
def backward_step(kernel: DynamicsKernel, mode: int, compiled: bool) -> tuple[Prelude, ca.Function]:
    """The prelude, and ``([x̄; q̄], t, h, flag, x, injected weights, q) → [x̄; q̄]``.

    ``compiled`` selects the form that is fastest as machine code.
    """
    step, period = kernel.variants[mode].step, kernel.fixed.period
    prelude, n = step.prelude, step.size
    if branches(step, period):  # two variants, each with its own prelude
        prelude = Prelude.identity(step.parameter_count)
        call, _ = with_flag(step, period, lambda step: step.adjoint)
    elif compiled:
        call, _ = with_flag(step, period, lambda step: step.compiled_adjoint)
    else:
        call, _ = with_flag(step, period, lambda step: step.prepared_adjoint)
    carried = ca.MX.sym("c", n + prelude.rate_count)
    q = ca.MX.sym("q", prelude.value_count)
    x, inject = ca.MX.sym("x", n), ca.MX.sym("i", n)
    t, h, flag = (ca.MX.sym(s) for s in ("t", "h", "flag"))
    x_bar, q_bar = call(flag, t, h, x, q, carried[:n])
    following = ca.vertcat(x_bar + inject, carried[n:] + q_bar)
    inputs = [carried, t, h, flag, x, inject, q]
    return prelude, ca.Function("backward_step", inputs, [following])
