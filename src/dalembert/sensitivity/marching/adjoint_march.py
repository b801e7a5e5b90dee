"""Adjoint gradients of dynamics: backward march over the recorded steps, in chunks."""

from __future__ import annotations

import numpy as np

from dalembert.sensitivity.marching.marched_sample import MarchedSample
from dalembert.sensitivity.marching.walk import BackwardWalk


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
        step = self.kernel.fixed.marched(mode)
        if step.at_once:
            return step.chunk_adjoint(count)(carried, *steps, p)[0].ravel()
        prelude, compiled = step.prelude, self.kernel.steps(mode).compiled
        first = np.append(carried[:n], np.zeros(prelude.rate_count))
        values = prelude.values(p).full()
        columns = self.kernel.marched(step.adjoint(compiled), (6,))
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
            _, back, p_bar = first.begin.adjoint(start, x0, p, x_bar[size:])
            weight, gradient = weight + back.full().ravel(), p_bar.full().ravel()
        y, v = self.assembled()
        _, y_bar, v_bar, p_bar = self.kernel.start.adjoint(start, y, v, p, weight)
        parts = self.model.initial_state.adjoint(start, y, p, y_bar, v_bar)
        return gradient + p_bar.full().ravel() + parts[2].full().ravel()
