"""How many workers there are, and work done in processes of their own.

Machine code runs in threads. All else (the virtual machine, and what Python decides step by step)
runs in copies of this process, where the system can copy one (Linux), else here.
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
"""Parts of the work for each worker, so that none waits long for the last."""

_task: Callable[[int], Any] | None = None
"""What the copies of this process were made for; they find it in their memory."""


def checked_workers(workers: int | None) -> int:
    """A number of workers; by default one for each core that this process may use.

    Raises
    ------
    AnalysisError
        It is no whole number from 1 on.
    """
    if workers is None:
        some = getattr(os, "sched_getaffinity", None)
        return len(some(0)) if some is not None else os.cpu_count() or 1
    if not is_whole(workers) or workers < 1:
        raise AnalysisError(f"workers is {workers!r:.60}; give a whole number from 1 on")
    return int(workers)


def can_copy() -> bool:
    """Whether the system copies a process with all that it has made."""
    return sys.platform == "linux" and "fork" in multiprocessing.get_all_start_methods()


def in_copies(
    task: Callable[[int], Any], numbers: Sequence[int], workers: int
) -> Iterator[tuple[int, Any]]:
    """``(number, task(number))`` as they are finished, by copies of this process.

    What has not been done when a copy dies, or what cannot be sent back, is left out.
    """
    global _task
    _task = task
    share = max(1, len(numbers) // (SHARES * workers))
    parts = [numbers[k : k + share] for k in range(0, len(numbers), share)]
    context = multiprocessing.get_context("fork")
    pool = ProcessPoolExecutor(workers, context, _ignore_interrupts)
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


def _ignore_interrupts() -> None:
    """The process that was copied decides what ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _several(numbers: list[int]) -> list[tuple[int, Any]]:
    assert _task is not None
    return [(k, _task(k)) for k in numbers]
