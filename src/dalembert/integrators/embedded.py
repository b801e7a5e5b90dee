"""Error control of explicit Runge–Kutta methods by their embedded solutions."""

from __future__ import annotations

from typing import TypeVar

import casadi as ca

from dalembert.integrators.base import Attempt, Problem
from dalembert.integrators.error_norm import largest, relative_error
from dalembert.integrators.explicit_step import ExplicitStep

STANDSTILL = 1e-10
Graph = TypeVar("Graph", ca.SX, ca.MX)


def embedded_attempt(problem: Problem, step: ExplicitStep, rtol: float, atol: float) -> Attempt:
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


def decide(
    state: Graph, end: Graph, h: Graph, new: Graph, ratio: Graph, error_order: int
) -> tuple[Graph, Graph]:
    """What follows an attempt with ``state = [t; proposed; last error; x]``, and its record.

    The length follows a PI controller (Gustafsson 1991).

    Parameters
    ----------
    end : of the run
    h, new : step length taken and state reached
    ratio : estimated error relative to the tolerance; not finite where the step failed
    error_order : ``q`` where the estimate falls as ``h^(q+1)``
    """
    t, proposed, last, x = state[0], state[1], state[2], state[3:]
    finite = ca.if_else(ratio <= 1e30, ratio, 1e30)  # false for NaN as well
    accepted = finite <= 1
    arrived = end - (t + h) <= 1e-12 * ca.fmax(1, ca.fabs(end))
    t_new = ca.if_else(accepted, ca.if_else(arrived, end, t + h), t)
    # the clipped last step must not make the controller believe in short steps
    factor = _growth(finite, last, accepted, error_order + 1)
    h_new = ca.if_else(ca.logic_and(accepted, h < proposed), proposed, h * factor)
    following = ca.vertcat(
        t_new,
        h_new,
        ca.if_else(accepted, ca.fmax(finite, 1e-4), last),
        ca.if_else(accepted, new, x),
    )
    return following, ca.vertcat(t, h, finite, accepted)


def _growth(error: Graph, last: Graph, accepted: Graph, q: int) -> Graph:
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
    allowed = atol + rtol * ca.fmax(ca.fabs(x), ca.fabs(new))

    def scaled(weights) -> ca.SX:
        parts = (w * k for w, k in zip(weights, slopes, strict=True) if w)
        error = h * sum(parts, ca.SX(0))
        return relative_error(problem, t + h, new, p, error, allowed)

    tableau = step.tableau
    error = scaled(tableau.b_error)
    if tableau.b_error_low is None:
        return largest(error)
    mean, low = (ca.sumsqr(e) / problem.controlled for e in (error, scaled(tableau.b_error_low)))
    return mean / ca.sqrt(mean + 0.01 * low + 1e-300)
