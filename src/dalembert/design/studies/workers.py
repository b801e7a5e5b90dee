"""Where the designs of a study are computed: here, in processes, or on a cluster.

All give the answers of chunks as they come, in any order. A chunk whose worker dies is given out
again; a design that takes its worker down even alone is answered as failed.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from dalembert.design.studies.task import Answer, StudyTask

DIED = "the process that computed it died"
TRIES = 2
"""Deaths of a design on its own before it is to blame: the first may be chance."""
AHEAD = 2
"""Chunks given out per worker, so that none waits for the next."""


@dataclass(frozen=True, eq=False)
class Chunk:
    """Some designs: numbers (n,), names of the parameters, values (n, k)."""

    numbers: np.ndarray
    names: tuple[str, ...]
    values: np.ndarray

    def parted(self) -> list[Chunk]:
        """Each design on its own."""
        each = range(self.numbers.size)
        return [Chunk(self.numbers[k : k + 1], self.names, self.values[k : k + 1]) for k in each]


class Workers(Protocol):
    """Who computes."""

    def answers(self, chunks: Sequence[Chunk]) -> Iterator[list[Answer]]:
        """The answers of each chunk as they come."""
        ...


def answer_chunk(task: StudyTask, chunk: Chunk) -> list[Answer]:
    """Run the designs of a chunk."""
    return task.answers(chunk.numbers, chunk.names, chunk.values)


@dataclass(frozen=True, eq=False)
class Here:
    """One after the other in this process."""

    task: StudyTask

    def answers(self, chunks: Sequence[Chunk]) -> Iterator[list[Answer]]:
        for chunk in chunks:
            yield answer_chunk(self.task, chunk)


_task: StudyTask | None = None


def _begin(make: Callable[[], StudyTask], parent: int) -> None:
    """A worker's first act: it has the task, leaves Ctrl-C to its parent, and ends with it."""
    global _task
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()
    _task = make()


def _end_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)


def _answer(chunk: Chunk) -> list[Answer]:
    assert _task is not None
    return answer_chunk(_task, chunk)


@dataclass(frozen=True, eq=False)
class Processes:
    """Several processes of this machine.

    Parameters
    ----------
    make : makes the task; sent to the workers where processes cannot be forked
    task : made already
    count : of the processes
    """

    make: Callable[[], StudyTask]
    task: StudyTask
    count: int

    def answers(self, chunks: Sequence[Chunk]) -> Iterator[list[Answer]]:
        left = dict(enumerate(chunks))
        while left:
            before = len(left)
            yield from self._together(left)
            if len(left) == before:  # one of those that were given out first takes workers down
                for key in list(left)[: AHEAD * self.count]:
                    yield self._alone(left.pop(key))

    def _together(self, left: dict[int, Chunk]) -> Iterator[list[Answer]]:
        """Answers until all are there or a worker dies; what is answered is taken out."""
        waiting = iter(list(left))
        running: dict[Future, int] = {}
        with self._pool(self.count) as pool:
            try:
                while True:
                    for key in waiting:
                        running[pool.submit(_answer, left[key])] = key
                        if len(running) >= AHEAD * self.count:
                            break
                    if not running:
                        return
                    for future in wait(running, return_when=FIRST_COMPLETED).done:
                        key = running.pop(future)
                        found = future.result()
                        del left[key]
                        yield found
            except BrokenProcessPool:
                return
            finally:
                pool.shutdown(wait=True, cancel_futures=True)

    def _alone(self, chunk: Chunk) -> list[Answer]:
        """Designs one by one; one that dies even so, and again, has failed."""
        return [a for one in chunk.parted() for a in self._tried(one)]

    def _tried(self, one: Chunk) -> list[Answer]:
        for _ in range(TRIES):
            with self._pool(1) as pool:
                try:
                    return pool.submit(_answer, one).result()
                except BrokenProcessPool:
                    continue
        return [self.task.failed(int(one.numbers[0]), DIED)]

    def _pool(self, count: int) -> ProcessPoolExecutor:
        forks = "fork" in multiprocessing.get_all_start_methods()
        context = multiprocessing.get_context("fork" if forks else "spawn")
        make = (lambda: self.task) if forks else self.make  # a forked process has it already
        return ProcessPoolExecutor(count, context, _begin, (make, os.getpid()))
