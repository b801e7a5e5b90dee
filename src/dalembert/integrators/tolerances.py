"""Tolerances of methods that control their errors."""

from __future__ import annotations

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import Problem

LEAST = 1e-10
"""Smallest absolute tolerance by natural sizes, where none is given."""


def share(rtol: float) -> float:
    """Absolute tolerance by natural sizes, where none is given: a hundredth of the relative one."""
    return max(LEAST, 1e-2 * rtol)


def absolute(atol: float | None, share: float, problem: Problem, count: int) -> np.ndarray:
    """(count,) absolute tolerances of x: given, or a share of the natural sizes."""
    return share * natural(problem, count) if atol is None else np.full(count, atol)


def natural(problem: Problem, count: int) -> np.ndarray:
    """(count,) natural sizes of the entries of x; units for what methods remember beside."""
    found = np.ones(count)
    if problem.sizes is not None:
        found[: problem.sizes.size] = problem.sizes
    return found


def check_tolerances(
    name: str, rtol: float, atol: float | None, max_step: float | None = None
) -> None:
    """Tolerances and the longest step must be positive.

    Raises
    ------
    UnsupportedError
        Names the method and what it was given.
    """
    if not (rtol > 0 and (atol is None or atol > 0)):
        raise UnsupportedError(f"{name}(rtol={rtol}, atol={atol}): tolerances must be positive")
    if max_step is not None and not max_step > 0:
        raise UnsupportedError(f"{name}(max_step={max_step}): must be positive")
