"""Norm of the error estimate relative to the tolerance, along and off the constraints."""

from __future__ import annotations

from typing import TypeVar

import casadi as ca

from dalembert.integrators.base import Problem

Graph = TypeVar("Graph", ca.SX, ca.MX)


def relative_error(
    problem: Problem, t: Graph, x: Graph, p: Graph, error: Graph, allowed: Graph
) -> Graph:
    """Entries of the error relative to the tolerance; a step is accepted if none exceeds 1.

    If a correction projects states onto the constraints (``problem.tangential``), the error
    component off the constraints is no error of the motion. Its tolerance is the square root, so
    that the correction converges; in a fully driven mechanism nothing else limits the step.

    Parameters
    ----------
    t, x, p : at the end of the step
    error, allowed : estimated error and tolerance of all states; only the leading
        ``problem.controlled`` entries are used
    """
    count = problem.controlled
    if problem.tangential is None:
        return ca.fabs(error[:count] / allowed[:count])
    along = problem.tangential(t, x, p, error)
    sizes = 1 if problem.sizes is None else problem.sizes[:count]
    off = ca.fabs(error - along)[:count] / ca.sqrt(allowed[:count] * sizes)
    return ca.fmax(ca.fabs(along)[:count] / allowed[:count], off)


def impulsive(problem: Problem, h: Graph, allowed: Graph) -> Graph:
    """Allowed errors for index 3 without correction: errors of speeds count ``h`` times.

    Off the constraints of index 3, errors of speeds do not decrease with the step; they are
    measured by the position errors that they cause within the step.
    """
    first, last = problem.positions, problem.controlled
    speeds = ca.fmax(allowed[first:last], allowed[: last - first] / h)
    return ca.vertcat(allowed[:first], speeds, allowed[last:])


def largest(ratios: Graph) -> Graph:
    """The largest entry; infinite if any is NaN, which a maximum would ignore."""
    if not ratios.numel():
        return ca.sumsqr(ratios)  # zero: no entries
    return ca.if_else(ca.sumsqr(ratios) < ca.inf, ca.mmax(ratios), ca.inf)
