"""Pools of processes on this machine.

Machine code runs in threads. Other work (the virtual machine and Python) runs in copies of this
process where the system supports them (Linux), otherwise in new processes or in this one.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import partial
from typing import Any, Generic, TypeVar

from dalembert.errors import AnalysisError
from dalembert.options import is_whole

T = TypeVar("T")
R = TypeVar("R")

SUBMITTED = 2
"""Submitted items per process, so that no process idles."""
SHARES = 8
"""Minimum number of parts of the work per worker, so that all finish at about the same time."""
LARGEST = 16
"""Upper limit of tasks in a part; a part that has begun is finished after an interruption."""
POLL = 0.5
"""Interval at which a process checks that its parent is alive [s]."""


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


@dataclass(frozen=True, eq=False)
class ProcessPool(Generic[T, R]):
    """Pool of processes that apply a task to items.

    Parameters
    ----------
    task : inherited by copies of this process
    count : number of processes
    make : function that builds the task in each process where processes cannot be copied
    ends_on_ctrl_c : whether processes end at once on Ctrl-C; otherwise they finish their items
    """

    task: Callable[[T], R]
    count: int
    make: Callable[[], Callable[[T], R]] | None = None
    ends_on_ctrl_c: bool = False

    @property
    def submitted(self) -> int:
        """Upper limit of items that are submitted at a time."""
        return SUBMITTED * self.count

    def completed(self, pending: dict[int, T]) -> Iterator[tuple[int, R]]:
        """Yield ``(key, result)`` in order of completion, and remove the item from ``pending``.

        Ends when all are done or a process dies; unfinished items remain in ``pending``.
        """
        keys = iter(list(pending))
        running: dict[Future[R], int] = {}
        pool = self._executor()
        try:
            while True:
                for key in keys:
                    running[pool.submit(_apply, pending[key])] = key
                    if len(running) >= self.submitted:
                        break
                if not running:
                    return
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    key = running.pop(future)
                    result = future.result()
                    del pending[key]
                    yield key, result
        except BrokenProcessPool:
            return
        finally:
            pool.shutdown(wait=True, cancel_futures=True)

    def _executor(self) -> ProcessPoolExecutor:
        copies = can_copy() or self.make is None
        context = multiprocessing.get_context("fork" if copies else "spawn")
        make = self.make if self.make is not None and not copies else lambda: self.task
        initialise = partial(_initialise, make, os.getpid(), self.ends_on_ctrl_c)
        return ProcessPoolExecutor(self.count, context, initialise)


_task: Callable[[Any], Any] | None = None
"""Task of this process of a pool."""


def _initialise(make: Callable[[], Any], parent: int, ends_on_ctrl_c: bool) -> None:
    """Build the task; the process ends quietly with its parent."""
    global _task
    signal.signal(signal.SIGINT, signal.SIG_DFL if ends_on_ctrl_c else signal.SIG_IGN)
    threading.Thread(target=_exit_with_parent, args=(parent,), daemon=True).start()
    _task = make()


def _exit_with_parent(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(POLL)
    os._exit(1)


def _apply(item: Any) -> Any:
    assert _task is not None
    return _task(item)


def in_copies(
    task: Callable[[int], R], numbers: Sequence[int], workers: int
) -> Iterator[tuple[int, R]]:
    """Yield ``(number, task(number))`` from copies of this process in order of completion.

    Tasks of a copy that dies and results that cannot be pickled are left out.
    """
    share = min(max(1, len(numbers) // (SHARES * workers)), LARGEST)
    parts = [numbers[k : k + share] for k in range(0, len(numbers), share)]

    def results(part: Sequence[int]) -> list[tuple[int, R]]:
        return [(k, task(k)) for k in part]

    pool = ProcessPool(results, workers, ends_on_ctrl_c=True)
    try:
        for _, completed in pool.completed(dict(enumerate(parts))):
            yield from completed
    except (pickle.PicklingError, TypeError, NotImplementedError):
        return
