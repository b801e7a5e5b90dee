"""Error control of explicit Runge–Kutta methods by their embedded solutions."""

from __future__ import annotations

import casadi as ca

from dalembert.integrators.base import Attempt, Problem
from dalembert.integrators.explicit_step import ExplicitStep

STANDSTILL = 1e-10


def embedded_attempt(problem: Problem, step: ExplicitStep, rtol: float, atol: float) -> Attempt:
    """Compute the step and its error, keep or refuse it, propose the next length.

    The length follows a PI controller (Gustafsson 1991). The error is taken along the
    constraints where the problem says how: what a correction removes is no error of the motion.
    """
    state = ca.SX.sym("s", 3 + step.size)
    fixed = ca.SX.sym("f", 2 + step.parameter_count)
    t, proposed, last, x = state[0], state[1], state[2], state[3:]
    end, longest, p = fixed[0], fixed[1], fixed[2:]
    h = ca.fmin(ca.fmin(proposed, longest), end - t)
    _, slopes = step.stages(t, h, x, p)
    new = step.advance(h, x, slopes)
    corrected = step.correct(t + h, new, p)
    ratio = _error_ratio(problem, step, rtol, atol, (t, h, x, corrected, p), slopes)
    finite = ca.if_else(ratio <= 1e30, ratio, 1e30)  # false for NaN as well
    accepted = finite <= 1
    arrived = end - (t + h) <= 1e-12 * ca.fmax(1, ca.fabs(end))
    t_new = ca.if_else(accepted, ca.if_else(arrived, end, t + h), t)
    # the clipped last step must not make the controller believe in short steps
    factor = _growth(finite, last, accepted, (step.tableau.error_order or 4) + 1)
    h_new = ca.if_else(ca.logic_and(accepted, h < proposed), proposed, h * factor)
    following = ca.vertcat(
        t_new,
        h_new,
        ca.if_else(accepted, ca.fmax(finite, 1e-4), last),
        ca.if_else(accepted, corrected, x),
    )
    record = ca.vertcat(t, h, finite, accepted)
    function = ca.Function("attempt", [state, fixed], [following, record], {"cse": True})
    return Attempt(function, (1.0,))


def _growth(error, last, accepted, q: int) -> ca.SX:
    """Factor of the next step length."""
    growth = 0.9 * ca.fmax(error, STANDSTILL) ** (-0.7 / q) * ca.fmax(last, STANDSTILL) ** (0.4 / q)
    return ca.if_else(
        accepted,
        ca.fmin(5, ca.fmax(0.2, growth)),
        ca.fmax(0.1, 0.9 * error ** (-1 / q)),
    )


def _error_ratio(problem: Problem, step: ExplicitStep, rtol, atol, where, slopes) -> ca.SX:
    """Estimated error relative to the tolerance."""
    t, h, x, new, p = where
    scale = (atol + rtol * ca.fmax(ca.fabs(x), ca.fabs(new)))[: problem.controlled]

    def scaled(weights) -> ca.SX:
        parts = (w * k for w, k in zip(weights, slopes, strict=True) if w)
        error = h * sum(parts, ca.SX(0))
        if problem.tangential is not None:
            error = problem.tangential(t + h, new, p, error)
        return error[: problem.controlled] / scale

    tableau = step.tableau
    error = scaled(tableau.b_error)
    if tableau.b_error_low is None:
        return ca.mmax(ca.fabs(error))
    mean, low = (ca.sumsqr(e) / problem.controlled for e in (error, scaled(tableau.b_error_low)))
    return mean / ca.sqrt(mean + 0.01 * low + 1e-300)
