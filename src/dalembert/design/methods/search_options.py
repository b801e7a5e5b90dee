"""Options of iterative searches: initial designs, stopping criteria and progress."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.budget import check_budget, numeral
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.options import is_number, is_whole

OnIteration = Callable[[int, float], None]
"""Called with the number of an iteration and its objective."""


def sobol_designs(count: int, lower: np.ndarray, upper: np.ndarray, rng: int = 0) -> np.ndarray:
    """(count, n) designs of a Sobol sequence between bounds."""
    from scipy.stats import qmc

    if count < 1:
        return np.empty((0, lower.size))
    power = int(np.ceil(np.log2(count)))
    unit = qmc.Sobol(lower.size, rng=rng).random_base2(power)[:count]
    return lower + unit * (upper - lower)


def refuse_infinite_bounds(
    method: str, names: Sequence[str], lower: np.ndarray, upper: np.ndarray
) -> None:
    """Refuse variables without two finite bounds, for methods that sample between them.

    Raises
    ------
    AnalysisError
        Names the first such variable.
    """
    for name, low, high in zip(names, lower, upper, strict=True):
        if not (np.isfinite(low) and np.isfinite(high)):
            raise AnalysisError(f"{method} needs two finite bounds of {name!r}; give them")


def check_starts(starts: int) -> int:
    """Checked number of starts.

    Raises
    ------
    AnalysisError
        It is not a positive integer.
    """
    if not isinstance(starts, int) or isinstance(starts, bool) or starts < 1:
        raise AnalysisError(f"starts is {starts!r:.30}; give a whole number, one or more")
    return starts


def additional_starts(
    starts: int, names: Sequence[str], lower: np.ndarray, upper: np.ndarray, rng: int
) -> list[np.ndarray]:
    """Initial designs between the bounds besides the first of ``starts``.

    Raises
    ------
    AnalysisError
        ``starts`` is invalid, or a variable lacks two finite bounds.
    """
    if check_starts(starts) == 1:
        return []
    refuse_infinite_bounds("starts", names, lower, upper)
    return list(sobol_designs(starts - 1, lower, upper, rng))


@dataclass
class Stop:
    """Stopping criteria.

    Parameters
    ----------
    max_iterations : of the optimiser
    tolerance : on the relative change of the scaled objective
    used : iterations of the search before this call

    Raises
    ------
    UnsupportedError
        One is not a number of zero or more, or ``max_iterations`` not an integer.
    BudgetError
        More iterations than the budget allows.
    """

    max_iterations: int = 100
    tolerance: float = 1e-8
    used: int = 0

    def __post_init__(self) -> None:
        check_stop(self.max_iterations, self.tolerance)


def check_stop(max_iterations: int, tolerance: float) -> None:
    """Refuse an invalid number of iterations or tolerance."""
    if not is_whole(max_iterations) or max_iterations < 0:
        text = numeral(max_iterations) if isinstance(max_iterations, int) else max_iterations
        raise UnsupportedError(
            f"max_iterations = {text!s:.60}: give a whole number of 0 or more, 100 is usual"
        )
    if not is_number(tolerance) or tolerance < 0:
        text = f"{tolerance!r:.60}"
        raise UnsupportedError(f"tolerance = {text}: give a number above 0, such as 1e-8")
    subject = f"max_iterations = {numeral(max_iterations)}"
    check_budget(subject, rounds=max_iterations, cure="give fewer max_iterations")


def iteration_callback(progress: bool | OnIteration) -> OnIteration | None:
    """Callback of the argument ``progress``: a function as is, True to print a line, or None."""
    if callable(progress):
        return progress
    if not progress:
        return None
    return lambda number, objective: print(f"iteration {number}: {objective:.8g}")
