"""How far an estimated error exceeds what is allowed, along the constraints and off them."""

from __future__ import annotations

from typing import TypeVar

import casadi as ca

from dalembert.integrators.base import Problem

Graph = TypeVar("Graph", ca.SX, ca.MX)


def relative_error(
    problem: Problem, t: Graph, x: Graph, p: Graph, error: Graph, allowed: Graph
) -> Graph:
    """Entries of the error over what is allowed; a step is good where none exceeds one.

    Where a correction moves states back onto the constraints (``problem.tangential``), what points
    off them is no error of the motion. It is allowed the square root of the tolerance, so that the
    correction finds its way; in a fully driven mechanism nothing else limits the step.

    Parameters
    ----------
    t, x, p : where the step arrives
    error, allowed : of all states; only the leading ``problem.controlled`` count
    """
    count = problem.controlled
    if problem.tangential is None:
        return ca.fabs(error[:count] / allowed[:count])
    along = problem.tangential(t, x, p, error)
    sizes = 1 if problem.sizes is None else problem.sizes[:count]
    off = ca.fabs(error - along)[:count] / ca.sqrt(allowed[:count] * sizes)
    return ca.fmax(ca.fabs(along)[:count] / allowed[:count], off)


def impulsive(problem: Problem, h: Graph, allowed: Graph) -> Graph:
    """Allowed errors where constraint forces of a step move the speeds: ``h`` times as much counts.

    Off the constraints of index 3, errors of speeds do not shrink with the step; they matter as
    those of positions that they make within it.
    """
    first, last = problem.positions, problem.controlled
    speeds = ca.fmax(allowed[first:last], allowed[: last - first] / h)
    return ca.vertcat(allowed[:first], speeds, allowed[last:])


def largest(ratios: Graph) -> Graph:
    """The largest entry; infinite where one is not a number, which a maximum would overlook."""
    if not ratios.numel():
        return ca.sumsqr(ratios)  # zero: there is nothing to be wrong
    return ca.if_else(ca.sumsqr(ratios) < ca.inf, ca.mmax(ratios), ca.inf)
