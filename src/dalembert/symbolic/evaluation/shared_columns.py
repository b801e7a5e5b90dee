"""Columns shared out among threads, where machine code evaluates them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from dalembert.symbolic.evaluation.columns import Columns

BLOCK = 4000
"""Columns at once."""


def in_blocks(columns: Columns, workers: int, *arguments: np.ndarray) -> list[np.ndarray]:
    """Results for many columns.

    Parameters
    ----------
    columns : of a function, none of whose arguments are carried or fixed
    workers : threads at most; the virtual machine has one
    arguments : (count, rows) each, a row for each column of the function

    Returns
    -------
    list
        (count, rows) each
    """
    return gathered_blocks(
        columns, workers, len(arguments[0]), BLOCK, lambda part: [a[part] for a in arguments]
    )


def gathered_blocks(
    columns: Columns,
    workers: int,
    count: int,
    block: int,
    given: Callable[[slice], Sequence[np.ndarray]],
    each: int = 1,
) -> list[np.ndarray]:
    """The same of ``count`` sets of ``each`` columns, whose arguments are gathered when needed.

    ``given`` tells the arguments, (columns, rows), of some of the sets; ``block`` is how many.
    """
    results = [np.empty((count * each, rows * wide)) for rows, wide in columns.shapes]

    def one(begin: int) -> None:
        part = slice(begin, min(begin + block, count))
        size = (part.stop - begin) * each
        found = columns(size, *(argument.T for argument in given(part)))
        for result, values in zip(results, found, strict=True):
            result[begin * each : begin * each + size] = values.T

    columns.announce(count * each)
    begins = range(0, count, block)
    for begin in begins[:1]:
        one(begin)
    share_out(one, begins[1:], workers if columns.compiled else 1)
    return results


def share_out(work: Callable[[int], None], parts: Sequence[int], workers: int) -> None:
    """Do parts of the work in threads, or here where one is enough."""
    if workers < 2 or len(parts) < 2:
        for part in parts:
            work(part)
        return
    with ThreadPoolExecutor(workers) as pool:
        for _ in pool.map(work, parts):
            pass
