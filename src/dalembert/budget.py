"""What a task may take: an absurd number is refused before memory or time is taken.

Everything is counted before it begins: bytes that are kept or that graphs need, and rounds of work
that Python does one after the other. ``DALEMBERT_BUDGET=10`` in the environment gives ten times
both.
"""

from __future__ import annotations

import math
import os

from dalembert.errors import BudgetError

MEMORY = 4e9
"""Bytes that one task may take."""
ROUNDS = 1e6
"""Rounds of one task, such as load steps, iterations or repeated runs."""
LARGEST = 1e100
"""Size of a number beyond which products of a few overflow."""
STEP = 48
"""Bytes of a time step beside its state: its time, length, marks, and copies of these."""
VARIABLE = "DALEMBERT_BUDGET"


def afford(
    what: str, *, memory: float = 0.0, rounds: float = 0.0, cure: str, doubt: float = 1.0
) -> None:
    """Go on only where a task takes no more than it is given.

    Parameters
    ----------
    what : the number at fault and what it makes, e.g. ``"outputs = 1e12"``
    memory : bytes it would take
    rounds : rounds it would take
    cure : what to give instead
    doubt : how many times too much an estimate may be

    Raises
    ------
    BudgetError
        It would take more; tells how much, and how to allow it.
    """
    factor, memory, rounds = _factor(), _float(memory), _float(rounds)
    share = max(memory / MEMORY, rounds / ROUNDS)
    if share <= factor * doubt:
        return
    by_memory = share == memory / MEMORY
    cost = f"{_size(memory)} of memory" if by_memory else f"{rounds:.3g} rounds"
    given = _size(factor * MEMORY) if by_memory else f"{factor * ROUNDS:.3g}"
    raise BudgetError(
        f"{what} would take about {cost}, and {given} are given; {cure}, or allow it by "
        f"{VARIABLE}={share * 1.01:.3g} in the environment"
    )


def _factor() -> float:
    text = os.environ.get(VARIABLE, "1")
    try:
        factor = float(text)
    except ValueError:
        factor = -1.0
    if not factor > 0:
        raise BudgetError(f"{VARIABLE} is {text!r}; set it to a number above 0, 1 is usual")
    return factor


def numeral(number: float) -> str:
    """A number in few characters, however large it is."""
    if isinstance(number, int) and abs(number) >= 10**15:
        return f"{'-' if number < 0 else ''}1e{math.log10(abs(number)):.0f}"
    return f"{number:.6g}" if isinstance(number, float) else str(number)


def _float(number: float) -> float:
    try:
        return float(number)
    except OverflowError:
        return math.inf


def _size(count: float) -> str:
    for unit in ("bytes", "kB", "MB", "GB", "TB", "PB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} EB"
