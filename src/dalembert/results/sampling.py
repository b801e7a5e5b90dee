"""Checked instants and state numbers for sampling results."""

from __future__ import annotations

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.result import Instants


def checked_instants(times: Instants) -> np.ndarray:
    """(K,) instants [s].

    Raises
    ------
    AnalysisError
        Empty, not numeric, or not finite.
    """
    try:
        instants = np.atleast_1d(np.asarray(times, dtype=float))
    except (TypeError, ValueError, OverflowError):
        instants = np.zeros(0)
    if instants.ndim != 1 or not instants.size or not np.all(np.isfinite(instants)):
        raise AnalysisError(f"times are {times!r:.60}; give one or more finite numbers of seconds")
    return instants


def checked_numbers(numbers: Instants, count: int, what: str) -> np.ndarray:
    """(K,) numbers from 0 to ``count − 1``; negative ones count from the end.

    Raises
    ------
    AnalysisError
        Empty, not integer, or out of range.
    """
    try:
        indices = np.atleast_1d(np.asarray(numbers, dtype=float))
    except (TypeError, ValueError, OverflowError):
        indices = np.zeros(0)
    valid = indices.ndim == 1 and indices.size > 0 and bool(np.all(indices == np.round(indices)))
    if not valid or indices.min() < -count or indices.max() >= count:
        raise AnalysisError(
            f"{what} {numbers!r:.60} do not exist; give whole numbers below {count}"
        )
    return indices.astype(int)
