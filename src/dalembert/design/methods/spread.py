"""Initial designs of searches with several starts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.errors import AnalysisError


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
