"""Second derivatives through time: the adjoint march, differentiated along a direction.

The forward march computes the change ``ẋ`` of the states along the direction; the backward march
propagates the weight of the state and its change, ``(x̄, d x̄)``, and accumulates ``d p̄``.

In an explicit Runge–Kutta step the stages ``X_i``, their changes ``Ẋ_i``, the weights ``X̄_i`` and
their changes are computed by the derivatives of ``F`` and of the correction; see ``ExplicitStep``
for the sums. The adjoints of other steps are differentiated by CasADi.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.errors import UnsupportedError
from dalembert.integrators.marching.march import with_flag
from dalembert.integrators.runge_kutta.explicit_step import ExplicitStep
from dalembert.integrators.step import Step
from dalembert.sensitivity.marching.direct_march import TangentMarch
from dalembert.sensitivity.marching.marched_sample import MarchedSample
from dalembert.sensitivity.marching.walk import BackwardWalk
from dalembert.sensitivity.samples import Sample, weights_change
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.once import once

Pair = tuple[ca.SX, ca.SX]


@once
def second_step(step: Step) -> ca.Function:
    """``(t, h, x, p, x̄⁺, ẋ, ṗ, d x̄⁺) → (x̄, d x̄, d p̄)``."""
    return _explicit(step) if isinstance(step, ExplicitStep) else _along(step.adjoint)


@once
def second_begin(step: Step) -> ca.Function:
    """``(t, x, p, m̄, ẋ, ṗ, d m̄) → (x̄, d x̄, d p̄)`` of a memory ``m(t, x, p)``."""
    begin = step.begin
    assert begin is not None
    t, x, p = (ca.MX.sym(begin.name_in(k), begin.size_in(k)) for k in range(3))
    weight = ca.MX.sym("w", begin.size_out(0))
    _, x_bar, p_bar = begin.reverse(1)(t, x, p, begin(t, x, p), weight)
    return _along(ca.Function("begin", [t, x, p, weight], [x_bar, p_bar]))


def _along(adjoint: ca.Function) -> ca.Function:
    """``(…, x, p, w, ẋ, ṗ, ẇ) → (x̄, d x̄, d p̄)`` from ``(…, x, p, w) → (x̄, p̄)``."""
    inputs = [ca.MX.sym(f"i{k}", adjoint.size_in(k)) for k in range(adjoint.n_in())]
    rates = [ca.MX.sym(f"d{k}", x.shape) for k, x in enumerate(inputs[-3:])]
    bars, zeros = adjoint(*inputs), [0] * (len(inputs) - 3)
    changes = adjoint.forward(1)(*inputs, *bars, *zeros, *rates)
    return ca.Function("second", [*inputs, *rates], [ca.densify(o) for o in (bars[0], *changes)])


def _explicit(step: ExplicitStep) -> ca.Function:
    t, h = ca.SX.sym("t"), ca.SX.sym("h")
    x, weight, dx, dweight = (ca.SX.sym(n, step.size) for n in ("x", "w", "dx", "dw"))
    p, dp = ca.SX.sym("p", step.parameter_count), ca.SX.sym("dp", step.parameter_count)
    states, slopes = step.stages(t, h, x, p, step.needed)
    changes, rates = _changes(step, t, h, states, p, dx, dp)
    end, p_bar = (weight, dweight), ca.SX.zeros(step.parameter_count)
    if step.finish is not None:
        new, dnew = step.advance(h, x, slopes), step.advance(h, dx, rates)
        end, p_bar = _pull_back(step.finish, t + h, (new, dnew), (p, dp), end)
    x_bar = end
    bars: dict[int, Pair] = {}
    for i in reversed(range(len(states))):
        seed = _weighted(end, h * step.tableau.b[i])
        for j, bar in bars.items():
            if step.tableau.a[j - 1][i] != 0:
                seed = _sum(seed, _weighted(bar, h * step.tableau.a[j - 1][i]))
        at = t + step.tableau.c[i] * h
        bars[i], more = _pull_back(step.rhs, at, (states[i], changes[i]), (p, dp), seed)
        x_bar, p_bar = _sum(x_bar, bars[i]), p_bar + more
    inputs = [t, h, x, p, weight, dx, dp, dweight]
    return ca.Function("second_step", inputs, [*map(ca.densify, x_bar), p_bar], {"cse": True})


def _changes(step: ExplicitStep, t, h, states, p, dx, dp) -> tuple[list[ca.SX], list[ca.SX]]:
    """``Ẋ_i`` and ``k̇_i``."""
    changes: list[ca.SX] = []
    rates: list[ca.SX] = []
    for i, state in enumerate(states):
        change = dx
        for a, r in zip(step.tableau.a[i - 1] if i else (), rates, strict=True):
            if a != 0:
                change = change + (h * a) * r
        changes.append(change)
        rates.append(step.rhs.tangent(t + step.tableau.c[i] * h, state, p, 0, change, dp))
    return changes, rates


def _pull_back(function: ImplicitFunction, t, x: Pair, p: Pair, weight: Pair) -> tuple[Pair, ca.SX]:
    """Weight of x and its change, and the change of the weight of p."""
    x_bar = function.adjoint(t, x[0], p[0], weight[0])[1]
    _, change, p_bar = function.reverse.tangent(t, x[0], p[0], weight[0], 0, x[1], p[1], weight[1])
    return (x_bar, change), p_bar


def _weighted(pair: Pair, factor) -> Pair:
    return factor * pair[0], factor * pair[1]


def _sum(a: Pair, b: Pair) -> Pair:
    return a[0] + b[0], a[1] + b[1]


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
        single = _back(self.kernel, int(self.steps.mode[begin]))
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
        """Weights of the outputs pulled back to the states they branch from."""
        k, n, steps = self.branches.index, self.size, self.steps
        if not steps.count:
            return pairs.sum(axis=1, keepdims=True), np.zeros(self.p.size)
        injected, p_bar = np.zeros((2 * n, steps.count + 1)), np.zeros(self.p.size)
        begins = self.branches.length == 0
        np.add.at(injected.T, k[begins], pairs[:, begins].T)
        np.add.at(injected.T, k[self.ends] + 1, pairs[:, self.ends].T)
        for mode, part in self.partial_steps(np.arange(k.size)):
            along = np.tile(self.direction[:, None], part.size)
            *back, more = self.kernel.over(second_step(self.step_of(mode)), part.size)(
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
            back = second_begin(self.first_step)(t, x0, p, pair[size:n], dx, d, pair[n + size :])
            more, change, p_bar = (part.full().ravel() for part in back)
            weight, dweight = weight + more, dweight + change
        point = (t, y, v, p, weight)
        _, y_bar, v_bar, _ = start.adjoint(*point)
        rates = start.reverse.tangent(*point, 0, *self._assembled, d, dweight)
        first = self.model.initial_state.reverse.tangent(
            t, y, p, y_bar, v_bar, 0, np.zeros(y.size), d, rates[1], rates[2]
        )
        return p_bar + rates[3].full().ravel() + first[2].full().ravel()


@once
def _back(kernel: DynamicsKernel, mode: int) -> ca.Function:
    """Backward step of ``[x̄; d x̄; d p̄]`` with injected weights."""
    step = kernel.variants[mode].step
    n, m = step.size, step.parameter_count
    call, symbolic = with_flag(step, kernel.fixed.period, second_step)
    kind: Any = ca.SX if symbolic else ca.MX
    sizes = {"c": 2 * n + m, "x": n, "dx": n, "i": 2 * n, "p": m, "dp": m}
    c, x, dx, inject, p, dp = (kind.sym(s, k) for s, k in sizes.items())
    t, h, flag = (kind.sym(s) for s in ("t", "h", "flag"))
    x_bar, change, more = call(flag, t, h, x, p, c[:n], dx, dp, c[n : 2 * n])
    following = ca.vertcat(ca.vertcat(x_bar, change) + inject, c[2 * n :] + more)
    return ca.Function("back", [c, t, h, flag, x, dx, inject, p, dp], [following])
