"""Error control of explicit Runge–Kutta methods by their embedded solutions."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.integrators.base import Attempt, Problem
from dalembert.integrators.error_norm import largest, relative_error
from dalembert.integrators.explicit_step import ExplicitStep
from dalembert.integrators.step_control import decide


def embedded_attempt(
    problem: Problem, step: ExplicitStep, rtol: float, atol: np.ndarray
) -> Attempt:
    """Compute the step and its error, keep or refuse it, propose the next length.

    What a correction removes counts little, see ``relative_error``.
    """
    state = ca.SX.sym("s", 3 + step.size)
    fixed = ca.SX.sym("f", 2 + step.parameter_count)
    t, proposed, x = state[0], state[1], state[3:]
    end, longest, p = fixed[0], fixed[1], fixed[2:]
    h = ca.fmin(ca.fmin(proposed, longest), end - t)
    _, slopes = step.stages(t, h, x, p)
    new = step.advance(h, x, slopes)
    corrected = step.correct(t + h, new, p)
    ratio = _error_ratio(problem, step, rtol, atol, (t, h, x, corrected, p), slopes)
    following, record = decide(state, end, h, corrected, ratio, step.tableau.error_order or 4)
    function = ca.Function("attempt", [state, fixed], [following, record], {"cse": True})
    return Attempt(function, (1.0,))


def _error_ratio(problem: Problem, step: ExplicitStep, rtol, atol, where, slopes) -> ca.SX:
    """Estimated error relative to the tolerance."""
    t, h, x, new, p = where
    allowed = ca.DM(atol) + rtol * ca.fmax(ca.fabs(x), ca.fabs(new))

    def scaled(weights) -> ca.SX:
        parts = (w * k for w, k in zip(weights, slopes, strict=True) if w)
        error = h * sum(parts, ca.SX(0))
        return relative_error(problem, t + h, new, p, error, allowed)

    tableau = step.tableau
    error = scaled(tableau.b_error)
    if tableau.b_error_low is None:
        return largest(error)
    count = max(problem.controlled, 1)  # nothing has no mean
    mean, low = (ca.sumsqr(e) / count for e in (error, scaled(tableau.b_error_low)))
    return mean / ca.sqrt(mean + 0.01 * low + 1e-300)
