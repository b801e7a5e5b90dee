"""Second derivatives through time: the adjoint march, differentiated along a direction.

Forwards, the change ``ẋ`` of the states along the direction; then backwards, the weight of the
state together with its change, ``(x̄, d x̄)``, collecting that of the parameters, ``d p̄``.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.errors import UnsupportedError
from dalembert.integrators.marching.march import flagged
from dalembert.sensitivity.marching.marched_sample import MarchedSample
from dalembert.sensitivity.marching.second_step import second_begin, second_step
from dalembert.sensitivity.marching.tangent_march import TangentMarch
from dalembert.sensitivity.marching.walk import BackwardWalk
from dalembert.sensitivity.samples import Sample, weights_change
from dalembert.symbolic.once import once


class SecondMarch(MarchedSample, BackwardWalk[np.ndarray]):
    """``H d`` of one sampled response.

    Parameters
    ----------
    sample : Sample
    direction : (np,) ``d``

    Raises
    ------
    UnsupportedError
        An integrator whose steps are not functions of the graph.
    """

    def __init__(self, sample: Sample, direction: np.ndarray):
        super().__init__(sample)
        self.direction = direction
        if self.kernel.integrator.gradient_error:
            raise UnsupportedError(
                f"second derivatives of {self.kernel.integrator.name} are no better than rough: "
                "its steps are not repeated exactly; use Bdf(), Radau() or RK4()"
            )

    def product(self) -> np.ndarray:
        """(np,) by one march forwards and one backwards.

        Raises
        ------
        UnsupportedError
            The run went over switches, whose transitions are right to first order.
        """
        if crossings := self.kernel.crossings(self.steps):
            what = "switches of forces" if self.kernel.contacts is None else "impacts and contacts"
            raise UnsupportedError(
                f"second derivatives through {what} are not available, and this run "
                f"went over {len(crossings)}, first at t = {self.steps.t[crossings[0][0]]:.6g} s; "
                "smooth the forces, or take differences of gradients"
            )
        found: list[np.ndarray] = []
        ahead = TangentMarch(
            self, self.direction[:, None], lambda _, changes: found.append(changes)
        )
        ahead.forwards()
        changes, every = np.concatenate(found), np.arange(self.modes.size)
        self._moved, self._assembled = changes[:, 0].T, ahead.assembled
        pairs, self._found = self._seen(ahead.at_outputs(self, every, 0, changes)[:, 0].T)
        self._injected, more = self._inject(pairs, self._moved)
        self._found += more
        self.backwards()
        return self._found

    def depart(self) -> np.ndarray:
        """``[x̄; d x̄; d p̄]``, which is carried, at the end."""
        return np.concatenate([self._injected[:, -1], np.zeros(self.p.size)])

    def pull(self, begin: int, end: int, weights: np.ndarray) -> np.ndarray:
        single = _back(self.kernel, int(self.steps.mode[begin]))
        back = self.kernel.marched(single, (single.n_in() - 2, single.n_in() - 1))
        given = self.given(begin, end, back=True)
        along = (x[:, begin:end][:, ::-1] for x in (self._moved, self._injected))
        (columns,) = back(end - begin, weights, *given, *along, self.p, self.direction)
        return columns[:, -1]

    def pull_start(self, weights: np.ndarray) -> None:
        n = 2 * self.size
        self._found += weights[n:] + self._through_start(weights[:n])

    def _seen(self, sampled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """``[x̄; d x̄]`` (2n, K) that the response sees, and ``d p̄`` (np,)."""
        times, size = self.motion.time, self.first_step.state_size
        still, along = np.zeros((1, times.size)), np.tile(self.direction[:, None], times.size)
        at = (self.modes, times, self.states, self.p)
        moves = (still, sampled[:size], along)
        (rates,) = self.kernel.mapped(lambda v: self.measured(v).tangent, *at, *moves)
        weights = self.sample.weights[None, :]
        turned = weights_change(self.sample, rates.ravel())[None, :]
        x_bar = self.kernel.mapped(lambda v: self.measured(v).adjoint, *at, weights)[1]
        _, change, p_bar = self.kernel.mapped(
            lambda v: self.measured(v).reverse.tangent, *at, weights, *moves, turned
        )
        memory = np.zeros((self.size - size, times.size))
        return np.vstack([x_bar, memory, change, memory]), p_bar.sum(axis=1)

    def _inject(self, pairs: np.ndarray, changes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the sampled states moved to the step ends they branch from."""
        k, n, steps = self.branches.index, self.size, self.steps
        if not steps.count:
            return pairs.sum(axis=1, keepdims=True), np.zeros(self.p.size)
        injected, p_bar = np.zeros((2 * n, steps.count + 1)), np.zeros(self.p.size)
        begins = self.branches.length == 0
        np.add.at(injected.T, k[begins], pairs[:, begins].T)
        np.add.at(injected.T, k[self.ends] + 1, pairs[:, self.ends].T)
        for mode, part in self.parts_of_steps(np.arange(k.size)):
            along = np.tile(self.direction[:, None], part.size)
            *back, more = self.kernel.over(second_step(self.step_of(mode)), part.size)(
                *self.partial(part), pairs[:n, part], changes[:, k[part]], along, pairs[n:, part]
            )
            np.add.at(injected.T, k[part], np.vstack(back).T)
            p_bar += more.sum(axis=1)
        return injected, p_bar

    def _through_start(self, pair: np.ndarray) -> np.ndarray:
        """``d p̄`` through the assembled initial state."""
        t, p, d, n = float(self.steps.t[0]), self.p, self.direction, self.size
        (y, v), start, size = self.assembled(), self.kernel.start, self.first_step.state_size
        weight, turned, found = pair[:size], pair[n : n + size], np.zeros(p.size)
        if self.first_step.begin is not None:
            x0, dx = self.steps.x[:size, 0], self._moved[:size, 0]
            back = second_begin(self.first_step)(t, x0, p, pair[size:n], dx, d, pair[n + size :])
            more, change, found = (part.full().ravel() for part in back)
            weight, turned = weight + more, turned + change
        given = (t, y, v, p, weight)
        _, y_bar, v_bar, _ = start.adjoint(*given)
        rates = start.reverse.tangent(*given, 0, *self._assembled, d, turned)
        first = self.model.initial_state.reverse.tangent(
            t, y, p, y_bar, v_bar, 0, np.zeros(y.size), d, rates[1], rates[2]
        )
        return found + rates[3].full().ravel() + first[2].full().ravel()


@once
def _back(kernel: DynamicsKernel, mode: int) -> ca.Function:
    """One step backwards: ``[x̄; d x̄; d p̄]`` that is carried, and what is seen on the way."""
    step = kernel.variants[mode].step
    n, m = step.size, step.parameter_count
    call, symbolic = flagged(step, kernel.fixed.period, second_step)
    kind: Any = ca.SX if symbolic else ca.MX
    sizes = {"c": 2 * n + m, "x": n, "dx": n, "i": 2 * n, "p": m, "dp": m}
    c, x, dx, inject, p, dp = (kind.sym(s, k) for s, k in sizes.items())
    t, h, flag = (kind.sym(s) for s in ("t", "h", "flag"))
    x_bar, change, more = call(flag, t, h, x, p, c[:n], dx, dp, c[n : 2 * n])
    following = ca.vertcat(ca.vertcat(x_bar, change) + inject, c[2 * n :] + more)
    return ca.Function("back", [c, t, h, flag, x, dx, inject, p, dp], [following])
