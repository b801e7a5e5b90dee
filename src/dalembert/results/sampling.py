"""Instants and numbers at which results are sampled, checked."""

from __future__ import annotations

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.result import Instants


def checked_instants(times: Instants) -> np.ndarray:
    """(K,) instants [s].

    Raises
    ------
    AnalysisError
        None at all, no numbers, or not finite.
    """
    try:
        found = np.atleast_1d(np.asarray(times, dtype=float))
    except (TypeError, ValueError, OverflowError):
        found = np.zeros(0)
    if found.ndim != 1 or not found.size or not np.all(np.isfinite(found)):
        raise AnalysisError(f"times are {times!r:.60}; give one or more finite numbers of seconds")
    return found


def checked_numbers(numbers: Instants, count: int, what: str) -> np.ndarray:
    """(K,) numbers from 0 to ``count − 1``; negative ones count from the end.

    Raises
    ------
    AnalysisError
        None at all, not whole, or none of these.
    """
    try:
        wanted = np.atleast_1d(np.asarray(numbers, dtype=float))
    except (TypeError, ValueError, OverflowError):
        wanted = np.zeros(0)
    whole = wanted.ndim == 1 and wanted.size > 0 and bool(np.all(wanted == np.round(wanted)))
    if not whole or wanted.min() < -count or wanted.max() >= count:
        raise AnalysisError(
            f"{what} {numbers!r:.60} do not exist; give whole numbers below {count}"
        )
    return wanted.astype(int)
