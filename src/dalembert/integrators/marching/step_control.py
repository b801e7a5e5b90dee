"""Step size control: acceptance of an attempted step and length of the next."""

from __future__ import annotations

from typing import TypeVar

import casadi as ca

STANDSTILL = 1e-10
"""Lower limit of the relative error in the step size controller [-]."""
Graph = TypeVar("Graph", ca.SX, ca.MX)


def decide(
    state: Graph,
    end: Graph,
    h: Graph,
    new: Graph,
    ratio: Graph,
    error_order: int,
    stiffness: Graph | float = 0.0,
) -> tuple[Graph, Graph]:
    """State and record after an attempt with ``state = [t; proposed; last error; x]``.

    The length follows a PI controller (Gustafsson 1991).

    Parameters
    ----------
    end : of the run
    h, new : length of the step and state after it
    ratio : estimated error relative to the tolerance; not finite if the step failed
    error_order : ``q`` if the estimate is of order ``h^(q+1)``
    stiffness : estimate of ``h ρ(∂F/∂x)``
    """
    t, proposed, last, x = state[0], state[1], state[2], state[3:]
    valid = ca.logic_and(ratio <= 1e30, ca.sumsqr(new) < ca.inf)  # false for NaN as well
    finite = ca.if_else(valid, ratio, 1e30)
    accepted = finite <= 1
    # a step clipped to the end must not shorten the proposed length
    factor = _growth(finite, last, accepted, error_order + 1)
    h_new = ca.if_else(ca.logic_and(accepted, h < proposed), proposed, h * factor)
    following = ca.vertcat(
        ca.if_else(accepted, arrival(t, h, end), t),
        h_new,
        ca.if_else(accepted, ca.fmax(finite, 1e-4), last),
        ca.if_else(accepted, new, x),
    )
    return following, ca.vertcat(t, h, finite, accepted, stiffness)


def arrival(t: Graph, h: Graph, end: Graph) -> Graph:
    """``t + h``, or the end itself if only a step of rounding size would remain."""
    return ca.if_else(end - (t + h) <= 1e-12 * ca.fmax(ca.fabs(t), ca.fabs(end)), end, t + h)


def _growth(error: Graph, last: Graph, accepted: Graph, q: int) -> Graph:
    """Factor of the next step length."""
    growth = 0.9 * ca.fmax(error, STANDSTILL) ** (-0.7 / q) * ca.fmax(last, STANDSTILL) ** (0.4 / q)
    return ca.if_else(
        accepted,
        ca.fmin(5, ca.fmax(0.2, growth)),
        ca.fmax(0.1, 0.9 * error ** (-1 / q)),
    )
