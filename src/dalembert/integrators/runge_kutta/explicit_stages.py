"""Stages of explicit Runge–Kutta methods, as numbers or expressions.

``k_i = F(t + c_i h, X_i, p)``, ``X_i = x + h Σ a_ij k_j``, ``x⁺ = x + h Σ b_i k_i``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dalembert.integrators.runge_kutta.tableau import ButcherTableau


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
