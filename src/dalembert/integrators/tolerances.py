"""Tolerances of integrators with error control."""

from __future__ import annotations

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import Problem

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
