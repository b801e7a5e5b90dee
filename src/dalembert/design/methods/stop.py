"""Stopping criteria of a search: iterations and tolerance."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.budget import afford, numeral
from dalembert.errors import UnsupportedError
from dalembert.options import is_number, is_whole


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
    afford(subject, rounds=max_iterations, cure="give fewer max_iterations")
