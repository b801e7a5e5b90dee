"""Limits of memory and work for a single task, checked before the task starts.

Estimates count the bytes of stored data and of expression graphs, and the rounds of work that
Python does in sequence. ``DALEMBERT_BUDGET=10`` in the environment multiplies both limits by ten.
"""

from __future__ import annotations

import math
import os

from dalembert.errors import BudgetError

MEMORY = 4e9
"""Upper limit of the memory of one task [bytes]."""
ROUNDS = 1e6
"""Upper limit of the rounds of one task, such as load steps, iterations or repeated runs."""
LARGEST = 1e100
"""Upper limit of the magnitude of a number; products of a few larger ones overflow."""
STEP = 48
"""Memory of a time step without its state: time, length, flags, and copies of these [bytes]."""
VARIABLE = "DALEMBERT_BUDGET"


def check_budget(
    subject: str, *, memory: float = 0.0, rounds: float = 0.0, cure: str, margin: float = 1.0
) -> None:
    """Refuse a task whose estimated cost exceeds the limits.

    Parameters
    ----------
    subject : the option at fault and its value, e.g. ``"outputs = 1e12"``
    memory : estimated memory [bytes]
    rounds : estimated number of rounds
    cure : recommended change
    margin : factor by which the estimate may exceed the limits

    Raises
    ------
    BudgetError
        A limit is exceeded; states the cost and the setting that allows it.
    """
    factor, memory, rounds = _factor(), _float(memory), _float(rounds)
    share = max(memory / MEMORY, rounds / ROUNDS)
    if share <= factor * margin:
        return
    by_memory = share == memory / MEMORY
    cost = f"{_size(memory)} of memory" if by_memory else f"{rounds:.3g} rounds"
    limit = _size(factor * MEMORY) if by_memory else f"{factor * ROUNDS:.3g}"
    raise BudgetError(
        f"{subject} would take about {cost}, and the limit is {limit}; {cure}, or allow it by "
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
    """Short text of a number of any magnitude."""
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
