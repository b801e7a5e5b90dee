"""Second derivatives through time: the adjoint march, differentiated along a direction.

The forward march computes the change ``ẋ`` of the states along the direction; the backward march
propagates the weight of the state and its change, ``(x̄, d x̄)``, and accumulates ``d p̄``.
"""

from __future__ import annotations

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.sensitivity.marching.direct_march import TangentMarch
from dalembert.sensitivity.marching.marched_sample import MarchedSample
from dalembert.sensitivity.marching.walk import BackwardWalk
from dalembert.sensitivity.samples import Sample, weights_change


class SecondMarch(MarchedSample, BackwardWalk[np.ndarray]):
    """``H d`` of one sampled response.

    Parameters
    ----------
    sample : Sample
    direction : (np,) ``d``

    Raises
    ------
    UnsupportedError
        An integrator without exact derivatives of its steps.
    """

    def __init__(self, sample: Sample, direction: np.ndarray):
        super().__init__(sample)
        self.direction = direction
        if self.kernel.integrator.gradient_error:
            raise UnsupportedError(
                f"second derivatives of {self.kernel.integrator.name} are inaccurate: "
                "its steps are not repeated exactly; use BDF(), Radau() or RK4()"
            )

    def product(self) -> np.ndarray:
        """(np,) product by one forward and one backward march.

        Raises
        ------
        UnsupportedError
            The run crosses switches, whose transitions have first-order derivatives only.
        """
        if crossings := self.kernel.crossings(self.steps):
            kind = "switches of forces" if self.kernel.contacts is None else "impacts and contacts"
            raise UnsupportedError(
                f"second derivatives through {kind} are not available, and this run "
                f"went over {len(crossings)}, first at t = {self.steps.t[crossings[0][0]]:.6g} s; "
                "smooth the forces, or take differences of gradients"
            )
        parts: list[np.ndarray] = []
        forward = TangentMarch(
            self, self.direction[:, None], lambda _, changes: parts.append(changes)
        )
        forward.forwards()
        changes, outputs = np.concatenate(parts), np.arange(self.modes.size)
        self._changes, self._assembled = changes[:, 0].T, forward.assembled
        at_outputs = forward.at_outputs(self, outputs, 0, changes)[:, 0].T
        pairs, self._product = self._output_weights(at_outputs)
        self._injected, more = self._inject(pairs, self._changes)
        self._product += more
        self.backwards()
        return self._product

    def depart(self) -> np.ndarray:
        """``[x̄; d x̄; d p̄]`` at the end."""
        return np.concatenate([self._injected[:, -1], np.zeros(self.p.size)])

    def pull(self, begin: int, end: int, weights: np.ndarray) -> np.ndarray:
        single = self.kernel.fixed.marched(int(self.steps.mode[begin])).second
        back = self.kernel.marched(single, (single.n_in() - 2, single.n_in() - 1))
        steps = self.step_data(begin, end, back=True)
        along = (x[:, begin:end][:, ::-1] for x in (self._changes, self._injected))
        (columns,) = back(end - begin, weights, *steps, *along, self.p, self.direction)
        return columns[:, -1]

    def pull_start(self, weights: np.ndarray) -> None:
        n = 2 * self.size
        self._product += weights[n:] + self._through_start(weights[:n])

    def _output_weights(self, changes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """``[x̄; d x̄]`` (2n, K) of the outputs, and ``d p̄`` (np,)."""
        times, size = self.motion.time, self.first_step.state_size
        dt, along = np.zeros((1, times.size)), np.tile(self.direction[:, None], times.size)
        at = (self.modes, times, self.states, self.p)
        tangent = (dt, changes[:size], along)
        (rates,) = self.kernel.mapped(lambda v: self.measured(v).tangent, *at, *tangent)
        weights = self.sample.weights[None, :]
        dweights = weights_change(self.sample, rates.ravel())[None, :]
        x_bar = self.kernel.mapped(lambda v: self.measured(v).adjoint, *at, weights)[1]
        _, change, p_bar = self.kernel.mapped(
            lambda v: self.measured(v).reverse.tangent, *at, weights, *tangent, dweights
        )
        memory = np.zeros((self.size - size, times.size))
        return np.vstack([x_bar, memory, change, memory]), p_bar.sum(axis=1)

    def _inject(self, pairs: np.ndarray, changes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the outputs pulled back to the states before them."""
        k, n, steps = self.places.index, self.size, self.steps
        if not steps.count:
            return pairs.sum(axis=1, keepdims=True), np.zeros(self.p.size)
        injected, p_bar = np.zeros((2 * n, steps.count + 1)), np.zeros(self.p.size)
        begins = self.places.length == 0
        np.add.at(injected.T, k[begins], pairs[:, begins].T)
        np.add.at(injected.T, k[self.ends] + 1, pairs[:, self.ends].T)
        for mode, part in self.partial_steps(np.arange(k.size)):
            along = np.tile(self.direction[:, None], part.size)
            *back, more = self.kernel.over(self.step_of(mode).second, part.size)(
                *self.partial_step_data(part),
                pairs[:n, part],
                changes[:, k[part]],
                along,
                pairs[n:, part],
            )
            np.add.at(injected.T, k[part], np.vstack(back).T)
            p_bar += more.sum(axis=1)
        return injected, p_bar

    def _through_start(self, pair: np.ndarray) -> np.ndarray:
        """``d p̄`` through the assembled initial state."""
        t, p, d, n = float(self.steps.t[0]), self.p, self.direction, self.size
        (y, v), start, size = self.assembled(), self.kernel.start, self.first_step.state_size
        weight, dweight, p_bar = pair[:size], pair[n : n + size], np.zeros(p.size)
        if self.first_step.begin is not None:
            x0, dx = self.steps.x[:size, 0], self._changes[:size, 0]
            back = self.first_step.begin.second(t, x0, p, pair[size:n], dx, d, pair[n + size :])
            more, change, p_bar = (part.full().ravel() for part in back)
            weight, dweight = weight + more, dweight + change
        point = (t, y, v, p, weight)
        _, y_bar, v_bar, _ = start.adjoint(*point)
        rates = start.reverse.tangent(*point, 0, *self._assembled, d, dweight)
        first = self.model.initial_state.reverse.tangent(
            t, y, p, y_bar, v_bar, 0, np.zeros(y.size), d, rates[1], rates[2]
        )
        return p_bar + rates[3].full().ravel() + first[2].full().ravel()
