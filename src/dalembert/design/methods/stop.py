"""When a search ends: iterations and tolerance."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.budget import check_budget, numeral
from dalembert.errors import UnsupportedError
from dalembert.options import is_number, is_whole


@dataclass
class Stop:
    """When to stop.

    Parameters
    ----------
    max_iterations : of the optimiser
    tolerance : on the relative change of the scaled objective
    used : iterations of the search before this call

    Raises
    ------
    UnsupportedError
        No whole number, or no number, of zero or more.
    BudgetError
        More iterations than a task may take.
    """

    max_iterations: int = 100
    tolerance: float = 1e-8
    used: int = 0

    def __post_init__(self) -> None:
        check_stop(self.max_iterations, self.tolerance)


def check_stop(max_iterations: int, tolerance: float) -> None:
    """Refuse a number of iterations or a tolerance at which no search can end."""
    if not is_whole(max_iterations) or max_iterations < 0:
        shown = numeral(max_iterations) if isinstance(max_iterations, int) else max_iterations
        raise UnsupportedError(
            f"max_iterations = {shown!s:.60}: give a whole number of 0 or more, 100 is usual"
        )
    if not is_number(tolerance) or tolerance < 0:
        shown = f"{tolerance!r:.60}"
        raise UnsupportedError(f"tolerance = {shown}: give a number above 0, such as 1e-8")
    what = f"max_iterations = {numeral(max_iterations)}"
    check_budget(what, rounds=max_iterations, cure="give fewer max_iterations")
