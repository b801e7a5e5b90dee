"""Stages of explicit Runge–Kutta methods, as numbers or expressions, and their second derivatives.

``k_i = F(t + c_i h, X_i, p)``, ``X_i = x + h Σ a_ij k_j``, ``x⁺ = x + h Σ b_i k_i``. The stages
``X_i``, their changes ``Ẋ_i``, their weights ``X̄_i`` and the changes of these follow from the
derivatives of the slopes and of the correction; see ``PreparedStages`` for the sums.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca

from dalembert.integrators.prepared_step import step_symbols
from dalembert.integrators.runge_kutta.tableau import ButcherTableau
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.evaluation.kernel import SELDOM, condensed
from dalembert.symbolic.once import once


def used_stages(tableau: ButcherTableau) -> list[int]:
    """Stages whose slopes enter the new state."""
    return [i for i in range(tableau.stages) if tableau.b[i] != 0]


def needed_stages(tableau: ButcherTableau) -> int:
    """Number of stages that the new state depends on."""
    return max(used_stages(tableau)) + 1


def stages(
    tableau: ButcherTableau, rhs: Callable[..., Any], t: Any, h: Any, x: Any, p: Any, count: int
) -> tuple[list[Any], list[Any]]:
    """States ``X_i`` and slopes ``k_i`` of the first ``count`` stages."""
    states: list[Any] = []
    slopes: list[Any] = []
    for i in range(count):
        state = x
        for a, k in zip(tableau.a[i - 1] if i else (), slopes, strict=True):
            if a != 0:
                state = state + (h * a) * k
        states.append(state)
        slopes.append(rhs(t + tableau.c[i] * h, state, p))
    return states, slopes


def advanced(tableau: ButcherTableau, h: Any, x: Any, slopes: list[Any]) -> Any:
    """``x + h Σ b_i k_i``, with slopes of equal weight summed first."""
    groups: dict[float, Any] = {}
    for i in used_stages(tableau):
        weight = tableau.b[i]
        groups[weight] = groups[weight] + slopes[i] if weight in groups else slopes[i]
    return x + sum((h * weight) * total for weight, total in groups.items())


Pair = tuple[ca.SX, ca.SX]
"""A quantity and its change."""


def second_derivative(
    tableau: ButcherTableau, rhs: ImplicitFunction, finish: ImplicitFunction | None
) -> ca.Function:
    """``(t, h, x, p, x̄⁺, ẋ, ṗ, d x̄⁺) → (x̄, d x̄, d p̄)`` of the step of a tableau.

    Parameters
    ----------
    tableau : ButcherTableau
    rhs : ImplicitFunction ``(t, x, p) → ẋ``
    finish : ImplicitFunction ``(t, x, p) → x`` after the stages, or None
    """
    _, size, parameter_count = rhs.input_sizes
    t, h, x, p = step_symbols(size, parameter_count, ca.SX)
    weight, dx, dweight = (ca.SX.sym(name, size) for name in ("w", "dx", "dw"))
    dp = ca.SX.sym("dp", parameter_count)
    states, slopes = stages(tableau, rhs.function, t, h, x, p, needed_stages(tableau))
    places = iter(states)

    def rate(at: ca.SX, change: ca.SX, dp: ca.SX) -> ca.SX:
        return rhs.tangent(at, next(places), p, 0, change, dp)

    changes, rates = stages(tableau, rate, t, h, dx, dp, len(states))
    end, p_bar = (weight, dweight), ca.SX.zeros(parameter_count)
    if finish is not None:
        new, dnew = advanced(tableau, h, x, slopes), advanced(tableau, h, dx, rates)
        end, p_bar = _pull_back(finish, t + h, (new, dnew), (p, dp), end)
    x_bar = end
    bars: dict[int, Pair] = {}
    for i in reversed(range(len(states))):
        seed = _weighted(end, h * tableau.b[i])
        for j, bar in bars.items():
            if tableau.a[j - 1][i] != 0:
                seed = _sum(seed, _weighted(bar, h * tableau.a[j - 1][i]))
        at = t + tableau.c[i] * h
        bars[i], more = _pull_back(rhs, at, (states[i], changes[i]), (p, dp), seed)
        x_bar, p_bar = _sum(x_bar, bars[i]), p_bar + more
    inputs = [t, h, x, p, weight, dx, dp, dweight]
    return condensed("second_step", inputs, [*map(ca.densify, x_bar), p_bar], SELDOM)


def _pull_back(function: ImplicitFunction, t, x: Pair, p: Pair, weight: Pair) -> tuple[Pair, ca.SX]:
    """Weight of x and its change, and the change of the weight of p."""
    x_bar, change, p_bar = _weights(function)(t, *x, *p, *weight)
    return (x_bar, change), p_bar


@once
def _weights(function: ImplicitFunction) -> ca.Function:
    """``(t, x, ẋ, p, ṗ, w, ẇ) → x̄, d x̄, d p̄``: adjoint and its tangent share half their terms."""
    t, *columns = function.reverse.inputs
    x, p, w = columns
    dx, dp, dw = (ca.SX.sym("d", symbols.numel()) for symbols in columns)
    x_bar = function.adjoint(t, x, p, w)[1]
    _, change, p_bar = function.reverse.tangent(t, x, p, w, 0, dx, dp, dw)
    return condensed("weights", [t, x, dx, p, dp, w, dw], [x_bar, change, p_bar])


def _weighted(pair: Pair, factor) -> Pair:
    return factor * pair[0], factor * pair[1]


def _sum(a: Pair, b: Pair) -> Pair:
    return a[0] + b[0], a[1] + b[1]
