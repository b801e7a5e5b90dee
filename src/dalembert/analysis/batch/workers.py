"""Number of workers, and execution of tasks in copies of this process.

Machine code runs in threads. Other work (the virtual machine and Python) runs in copies of this
process where the system supports them (Linux), otherwise in this process.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from dalembert.errors import AnalysisError
from dalembert.options import is_whole

SHARES = 8
"""Minimum number of parts of the work per worker, so that all finish at about the same time."""
LARGEST = 16
"""Upper limit of tasks in a part; a part that has begun is finished after an interruption."""

_task: Callable[[int], Any] | None = None
"""Task of the copies of this process, which inherit it."""


def checked_workers(workers: int | None) -> int:
    """A number of workers; by default one for each core that this process may use.

    Raises
    ------
    AnalysisError
        Not a whole number from 1 on.
    """
    if workers is None:
        affinity = getattr(os, "sched_getaffinity", None)
        return len(affinity(0)) if affinity is not None else os.cpu_count() or 1
    if not is_whole(workers) or workers < 1:
        raise AnalysisError(f"workers is {workers!r:.60}; give a whole number from 1 on")
    return int(workers)


def can_copy() -> bool:
    """Whether the system can copy a process with its memory."""
    return sys.platform == "linux" and "fork" in multiprocessing.get_all_start_methods()


def in_copies(
    task: Callable[[int], Any], numbers: Sequence[int], workers: int
) -> Iterator[tuple[int, Any]]:
    """Yield ``(number, task(number))`` from copies of this process in order of completion.

    Tasks of a copy that dies and results that cannot be pickled are left out.
    """
    global _task
    _task = task
    share = min(max(1, len(numbers) // (SHARES * workers)), LARGEST)
    parts = [numbers[k : k + share] for k in range(0, len(numbers), share)]
    context = multiprocessing.get_context("fork")
    pool = ProcessPoolExecutor(workers, context, _end_when_interrupted)
    try:
        waiting = {pool.submit(_several, list(part)) for part in parts}
        while waiting:
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for part in done:
                yield from part.result()
    except (BrokenProcessPool, pickle.PicklingError, TypeError, NotImplementedError):
        return
    finally:
        _task = None
        pool.shutdown(wait=True, cancel_futures=True)


def _end_when_interrupted() -> None:
    """End quietly: finished results are sent, and the parent process reports the interruption."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _several(numbers: list[int]) -> list[tuple[int, Any]]:
    assert _task is not None
    return [(k, _task(k)) for k in numbers]
