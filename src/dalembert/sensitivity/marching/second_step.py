"""Adjoints of steps, differentiated along a direction.

In an explicit Runge–Kutta step the stages ``X_i``, their changes ``Ẋ_i``, the weights ``X̄_i`` and
their changes are computed by the derivatives of ``F`` and of the correction; see ``ExplicitStep``
for the sums. The adjoints of other steps are differentiated by CasADi.
"""

from __future__ import annotations

import casadi as ca

from dalembert.integrators.runge_kutta.explicit_step import ExplicitStep
from dalembert.integrators.step import Step
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
        end, p_bar = _back(step.finish, t + h, (new, dnew), (p, dp), end)
    x_bar = end
    bars: dict[int, Pair] = {}
    for i in reversed(range(len(states))):
        seed = _weighted(end, h * step.tableau.b[i])
        for j, bar in bars.items():
            if step.tableau.a[j - 1][i] != 0:
                seed = _sum(seed, _weighted(bar, h * step.tableau.a[j - 1][i]))
        at = t + step.tableau.c[i] * h
        bars[i], more = _back(step.rhs, at, (states[i], changes[i]), (p, dp), seed)
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


def _back(function: ImplicitFunction, t, x: Pair, p: Pair, weight: Pair) -> tuple[Pair, ca.SX]:
    """Weight of x and its change, and the change of the weight of p."""
    x_bar = function.adjoint(t, x[0], p[0], weight[0])[1]
    _, change, p_bar = function.reverse.tangent(t, x[0], p[0], weight[0], 0, x[1], p[1], weight[1])
    return (x_bar, change), p_bar


def _weighted(pair: Pair, factor) -> Pair:
    return factor * pair[0], factor * pair[1]


def _sum(a: Pair, b: Pair) -> Pair:
    return a[0] + b[0], a[1] + b[1]
