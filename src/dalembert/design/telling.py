"""How searches tell how far they are."""

from __future__ import annotations

from collections.abc import Callable

Told = Callable[[int, float], None]
"""Is told the number of an iteration and the objective there."""


def teller(progress: bool | Told) -> Told | None:
    """What ``progress=`` asks for: a function as it is, True prints a line, False nothing."""
    if callable(progress):
        return progress
    if not progress:
        return None
    return lambda number, objective: print(f"iteration {number}: {objective:.8g}")
