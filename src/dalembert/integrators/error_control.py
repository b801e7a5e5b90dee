"""Error control: tolerances, norm of the error estimate, step size controller."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TypeVar

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import Integrator, Problem
from dalembert.options import options

ATOL_FLOOR = 1e-10
"""Lower limit of the default absolute tolerance, relative to natural sizes [-]."""


def share(rtol: float) -> float:
    """Default absolute tolerance relative to natural sizes: a hundredth of ``rtol``."""
    return max(ATOL_FLOOR, 1e-2 * rtol)


def absolute(atol: float | None, share: float, problem: Problem, count: int) -> np.ndarray:
    """(count,) absolute tolerances of x: ``atol``, by default a share of the natural sizes."""
    return share * natural(problem, count) if atol is None else np.full(count, atol)


def natural(problem: Problem, count: int) -> np.ndarray:
    """(count,) natural sizes of the entries of x; ones for the memory of a method."""
    sizes = np.ones(count)
    if problem.sizes is not None:
        sizes[: problem.sizes.size] = problem.sizes
    return sizes


def check_tolerances(
    name: str, rtol: float, atol: float | None, max_step: float | None = None
) -> None:
    """Raise unless tolerances and the longest step are positive.

    Raises
    ------
    UnsupportedError
        Names the method and the invalid value.
    """
    if not (rtol > 0 and (atol is None or atol > 0)):
        raise UnsupportedError(f"{name}(rtol={rtol}, atol={atol}): tolerances must be positive")
    if max_step is not None and not max_step > 0:
        raise UnsupportedError(f"{name}(max_step={max_step}): must be positive")


@options
class ErrorControlled(Integrator, ABC):
    """Integrator whose step length follows the estimated error of coordinates and speeds.

    Parameters
    ----------
    rtol : relative tolerance [-]
    atol : absolute tolerance [m, rad, m/s, rad/s]; by default a hundredth of rtol, at
        least 1e-10, times the natural sizes
    max_step : longest step [s]; a quarter of the run if None

    Raises
    ------
    UnsupportedError
        A tolerance or ``max_step`` that is not positive.
    """

    rtol: float = 1e-8
    atol: float | None = None
    max_step: float | None = None

    def __post_init__(self) -> None:
        check_tolerances(self.name, self.rtol, self.atol, self.max_step)

    @property
    @abstractmethod
    def order(self) -> int:
        """Order of the method."""

    @property
    def adaptive(self) -> bool:
        return True

    @property
    def longest_step(self) -> float | None:
        return self.max_step


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


STANDSTILL = 1e-10
"""Lower limit of the relative error in the step size controller [-]."""


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
