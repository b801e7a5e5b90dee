"""Explicit Runge–Kutta step and its attempts under error control by the embedded solution.

``x⁺ = P(x + h Σ b_i k_i)`` with ``P`` the correction of the state.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.integrators.base import Attempt, Problem
from dalembert.integrators.error_control import Graph, decide, largest, relative_error
from dalembert.integrators.runge_kutta.explicit_stages import (
    advanced,
    needed_stages,
    second_derivative,
    stages,
)
from dalembert.integrators.runge_kutta.prepared_stages import PreparedStages
from dalembert.integrators.runge_kutta.tableau import ButcherTableau
from dalembert.integrators.step import Step
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.evaluation.columns import LONG
from dalembert.symbolic.evaluation.kernel import condensed


class ExplicitStep(Step):
    """Explicit Runge–Kutta step ``(t, h, x, p) → x⁺``.

    Parameters
    ----------
    tableau : ButcherTableau
    rhs : ImplicitFunction ``(t, x, p) → ẋ``
    correction : ImplicitFunction ``(t, x, p) → x``, or None
    upkeep : the same for a step without correction, or None
    """

    def __init__(
        self,
        tableau: ButcherTableau,
        rhs: ImplicitFunction,
        correction: ImplicitFunction | None,
        upkeep: ImplicitFunction | None = None,
    ):
        self.tableau, self.rhs, self.upkeep = tableau, rhs, upkeep
        self.finish = upkeep if correction is None else correction
        _, self.size, self.parameter_count = rhs.input_sizes
        self.state_size = self.size
        self.corrects = correction is not None

    def stages(self, t, h, x, p, count: int | None = None) -> tuple[list[Any], list[Any]]:
        """Stage states ``X_i`` and slopes ``k_i``; by default of all stages."""
        count = self.tableau.stages if count is None else count
        return stages(self.tableau, self.rhs.function, t, h, x, p, count)

    def advance(self, t, h, x, slopes, p) -> Any:
        """The new state after the correction."""
        new = advanced(self.tableau, h, x, slopes)
        return new if self.finish is None else self.finish.function(t + h, new, p)

    @cached_property
    def function(self) -> ca.Function:
        t, h, x, p = self._symbols(ca.SX)
        _, slopes = self.stages(t, h, x, p, needed_stages(self.tableau))
        new = self.advance(t, h, x, slopes, p)
        return ca.Function("step", [t, h, x, p], [new], self.prepared.cse)

    @property
    def work(self) -> float:
        """Of the functions of which the step consists; for this count the step is not built."""
        finish = 0 if self.finish is None else self.finish.function.n_instructions()
        slopes = needed_stages(self.tableau) * self.rhs.function.n_instructions()
        return float(slopes + finish)

    @cached_property
    def prepared(self) -> PreparedStages:
        return PreparedStages(self.tableau, self.rhs, self.finish)

    @cached_property
    def second(self) -> ca.Function:
        return second_derivative(self.tableau, self.rhs, self.finish)

    @cached_property
    def plain(self) -> ExplicitStep:
        return ExplicitStep(self.tableau, self.rhs, None, self.upkeep)

    @property
    def rate(self) -> ImplicitFunction:
        return self.rhs

    @property
    def stability(self) -> Callable[[np.ndarray], np.ndarray]:
        return self.tableau.stability


def embedded_attempt(
    problem: Problem, step: ExplicitStep, rtol: float, atol: np.ndarray
) -> Attempt:
    """Attempted step with embedded error estimate, acceptance test and next length.

    Errors that the correction removes have a wider tolerance, see ``relative_error``.
    """
    control = _control(problem, step, rtol, atol)

    def attempt(kind: Any) -> ca.Function:
        state, fixed = kind.sym("s", 3 + step.size), kind.sym("f", 2 + step.parameter_count)
        t, x, p = state[0], state[3:], fixed[2:]
        h = _length(state, fixed)
        states, slopes = step.stages(t, h, x, p)
        new = step.advance(t, h, x, slopes, p)
        stiff = _stiffness(problem, step, h, states, slopes)
        out: Any = control(state, fixed, new, ca.horzcat(*slopes), stiff)
        if kind is ca.SX:  # longer ones are compiled in the form with calls
            return condensed("attempt", [state, fixed], out, LONG)
        return ca.Function("attempt", [state, fixed], out)

    return Attempt(attempt(ca.SX), (1.0,), attempt(ca.MX))


def _length(state: Graph, fixed: Graph) -> Graph:
    """Step length: the proposed one, limited by the longest step and the end of the run."""
    return ca.fmin(ca.fmin(state[1], fixed[1]), fixed[0] - state[0])


def _control(problem: Problem, step: ExplicitStep, rtol: float, atol: np.ndarray) -> ca.Function:
    """``(state, fixed, new, slopes, stiffness) → (following, record)``."""
    state, fixed = ca.SX.sym("s", 3 + step.size), ca.SX.sym("f", 2 + step.parameter_count)
    slopes, new = ca.SX.sym("k", step.size, step.tableau.stages), ca.SX.sym("n", step.size)
    stiff, order = ca.SX.sym("stiffness"), step.tableau.error_order or 4
    t, x, h = state[0], state[3:], _length(state, fixed)
    ratio = _error_ratio(problem, step, rtol, atol, (t, h, x, new, fixed[2:]), ca.horzsplit(slopes))
    following, record = decide(state, fixed[0], h, new, ratio, order, stiff)
    inputs = [state, fixed, new, slopes, stiff]
    return ca.Function("control", inputs, [following, record], {"cse": True})


def _stiffness(problem: Problem, step: ExplicitStep, h: Graph, states: Any, slopes: Any) -> Graph:
    """``h ‖k_s − k_{s−1}‖ / ‖X_s − X_{s−1}‖`` (Hairer and Wanner 1996, IV.2), in natural sizes.

    Requires the last two stages at the same time; 0 otherwise.
    """
    c, count = step.tableau.c, problem.controlled
    if len(c) < 2 or c[-1] != c[-2] or not count:
        return h * 0
    sizes = np.ones(count) if problem.sizes is None else problem.sizes[:count]
    change, distance = (
        ca.sumsqr((values[-1] - values[-2])[:count] / sizes) for values in (slopes, states)
    )
    return h * ca.sqrt(change / (distance + 1e-300))


def _error_ratio(problem: Problem, step: ExplicitStep, rtol, atol, point, slopes) -> ca.SX:
    """Estimated error relative to the tolerance."""
    t, h, x, new, p = point
    allowed = ca.DM(atol) + rtol * ca.fmax(ca.fabs(x), ca.fabs(new))

    def scaled(weights) -> ca.SX:
        parts = (w * k for w, k in zip(weights, slopes, strict=True) if w)
        error = h * sum(parts, ca.SX(0))
        return relative_error(problem, t + h, new, p, error, allowed)

    tableau = step.tableau
    error = scaled(tableau.b_error)
    if tableau.b_error_low is None:
        return largest(error)
    count = max(problem.controlled, 1)  # avoids 0/0
    mean, low = (ca.sumsqr(e) / count for e in (error, scaled(tableau.b_error_low)))
    return mean / ca.sqrt(mean + 0.01 * low + 1e-300)
