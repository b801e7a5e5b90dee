"""Tolerances of methods that control their errors."""

from __future__ import annotations

from dalembert.errors import UnsupportedError


def check_tolerances(name: str, rtol: float, atol: float, max_step: float | None = None) -> None:
    """Tolerances and the longest step must be positive.

    Raises
    ------
    UnsupportedError
        Names the method and what it was given.
    """
    if not (rtol > 0 and atol > 0):
        raise UnsupportedError(f"{name}(rtol={rtol}, atol={atol}): tolerances must be positive")
    if max_step is not None and not max_step > 0:
        raise UnsupportedError(f"{name}(max_step={max_step}): must be positive")
