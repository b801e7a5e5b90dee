"""Progress of iterative searches."""

from __future__ import annotations

from collections.abc import Callable

OnIteration = Callable[[int, float], None]
"""Called with the number of an iteration and its objective."""


def iteration_callback(progress: bool | OnIteration) -> OnIteration | None:
    """Callback of the argument ``progress``: a function as is, True to print a line, or None."""
    if callable(progress):
        return progress
    if not progress:
        return None
    return lambda number, objective: print(f"iteration {number}: {objective:.8g}")
