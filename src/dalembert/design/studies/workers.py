"""Backends that evaluate the designs of a study: in-process, process pool or Dask cluster.

All yield the answers of chunks as they arrive, in any order. A chunk whose worker dies is submitted
again; a design that kills its worker even alone is recorded as failed.
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
from typing import Any, Protocol

import numpy as np

from dalembert.design.studies.task import Answer, StudyTask
from dalembert.errors import AnalysisError
from dalembert.packages import optional_package

DIED = "the process that computed it died"
MAX_TRIES = 2
"""Runs of a single design whose worker dies until the design counts as failed."""
CHUNKS_AHEAD = 2
"""Submitted chunks per worker, so that no worker idles."""
WAIT = 5.0
"""Upper limit of the time to connect to the scheduler [s]."""
_task_lock = threading.Lock()
"""Serialises the threads of a worker, as compiled functions are not thread-safe."""


@dataclass(frozen=True, eq=False)
class Chunk:
    """Chunk of designs: numbers (n,), names of the parameters, values (n, k)."""

    numbers: np.ndarray
    names: tuple[str, ...]
    values: np.ndarray

    def split(self) -> list[Chunk]:
        """Chunks of single designs."""
        indices = range(self.numbers.size)
        return [Chunk(self.numbers[k : k + 1], self.names, self.values[k : k + 1]) for k in indices]


class Workers(Protocol):
    """Protocol of the backends."""

    def answers(self, chunks: Sequence[Chunk]) -> Iterator[list[Answer]]:
        """Yield the answers of each chunk as they arrive."""
        ...


def answer_chunk(task: StudyTask, chunk: Chunk) -> list[Answer]:
    """Run the designs of a chunk."""
    return task.answers(chunk.numbers, chunk.names, chunk.values)


@dataclass(frozen=True, eq=False)
class InProcess:
    """Sequential evaluation in this process."""

    task: StudyTask

    def answers(self, chunks: Sequence[Chunk]) -> Iterator[list[Answer]]:
        for chunk in chunks:
            yield answer_chunk(self.task, chunk)


_task: StudyTask | None = None


def _initialise_worker(make: Callable[[], StudyTask], parent: int) -> None:
    """Initialise a worker: build the task, ignore Ctrl-C, and exit with the parent process."""
    global _task
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_exit_with_parent, args=(parent,), daemon=True).start()
    _task = make()


def _exit_with_parent(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)


def _answer(chunk: Chunk) -> list[Answer]:
    assert _task is not None
    return answer_chunk(_task, chunk)


@dataclass(frozen=True, eq=False)
class Processes:
    """Pool of local processes.

    Parameters
    ----------
    make : function that builds the task, sent to the workers if processes cannot be forked
    task : task built in this process
    count : number of processes
    """

    make: Callable[[], StudyTask]
    task: StudyTask
    count: int

    def answers(self, chunks: Sequence[Chunk]) -> Iterator[list[Answer]]:
        pending = dict(enumerate(chunks))
        while pending:
            remaining = len(pending)
            yield from self._run_until_death(pending)
            if len(pending) == remaining:  # one of the first submitted chunks kills its worker
                for key in list(pending)[: CHUNKS_AHEAD * self.count]:
                    yield self._run_single(pending.pop(key))

    def _run_until_death(self, pending: dict[int, Chunk]) -> Iterator[list[Answer]]:
        """Yield answers until all chunks are done or a worker dies; updates ``pending``."""
        keys = iter(list(pending))
        running: dict[Future, int] = {}
        with self._pool(self.count) as pool:
            try:
                while True:
                    for key in keys:
                        running[pool.submit(_answer, pending[key])] = key
                        if len(running) >= CHUNKS_AHEAD * self.count:
                            break
                    if not running:
                        return
                    for future in wait(running, return_when=FIRST_COMPLETED).done:
                        key = running.pop(future)
                        answers = future.result()
                        del pending[key]
                        yield answers
            except BrokenProcessPool:
                return
            finally:
                pool.shutdown(wait=True, cancel_futures=True)

    def _run_single(self, chunk: Chunk) -> list[Answer]:
        """Run designs one by one; a design that kills its worker repeatedly fails."""
        return [answer for single in chunk.split() for answer in self._retry(single)]

    def _retry(self, chunk: Chunk) -> list[Answer]:
        for _ in range(MAX_TRIES):
            with self._pool(1) as pool:
                try:
                    return pool.submit(_answer, chunk).result()
                except BrokenProcessPool:
                    continue
        return [self.task.failed(int(chunk.numbers[0]), DIED)]

    def _pool(self, count: int) -> ProcessPoolExecutor:
        forks = "fork" in multiprocessing.get_all_start_methods()
        context = multiprocessing.get_context("fork" if forks else "spawn")
        make = (lambda: self.task) if forks else self.make  # inherited by forked processes
        return ProcessPoolExecutor(count, context, _initialise_worker, (make, os.getpid()))


_cluster_tasks: dict[str, StudyTask] = {}
"""Task of the current study on this worker, cached as it is expensive to build."""


def answer_on_worker(identity: str, make: Callable[[], StudyTask], chunk: Chunk) -> list[Answer]:
    """Answers of a chunk, computed on a worker; builds the task once."""
    with _task_lock:
        if identity not in _cluster_tasks:
            _cluster_tasks.clear()
            _cluster_tasks[identity] = make()
        return answer_chunk(_cluster_tasks[identity], chunk)


@dataclass(frozen=True, eq=False)
class Cluster:
    """Workers of a Dask scheduler, which replaces workers that die.

    Parameters
    ----------
    scheduler : address, such as ``tcp://host:8786``
    make : function that builds the task on each worker
    task : task built in this process
    identity : hash of the study
    """

    scheduler: str
    make: Callable[[], StudyTask]
    task: StudyTask
    identity: str

    def answers(self, chunks: Sequence[Chunk]) -> Iterator[list[Answer]]:
        distributed = optional_package("distributed", "a study on a cluster")
        try:
            client = distributed.Client(self.scheduler, timeout=WAIT, set_as_default=False)
        except (OSError, ValueError) as error:
            raise AnalysisError(
                f"there is no Dask scheduler at {self.scheduler} ({error}); start one with "
                "'dask scheduler', and workers with 'dask worker ADDRESS --nthreads 1'"
            ) from None
        with client:
            yield from self._answers(distributed, client, list(chunks))

    def _answers(
        self, distributed: Any, client: Any, chunks: list[Chunk]
    ) -> Iterator[list[Answer]]:
        def submit(chunk: Chunk) -> Any:
            future = client.submit(answer_on_worker, self.identity, self.make, chunk, pure=False)
            submitted[future.key] = chunk
            return future

        submitted: dict[str, Chunk] = {}
        running = distributed.as_completed([submit(chunk) for chunk in chunks], loop=client.loop)
        for future in running:
            chunk = submitted.pop(future.key)
            if future.status == "finished":
                yield future.result()
            elif future.status != "error" and client.status == "running":
                running.add(submit(chunk))  # lost with its worker
            elif future.status != "error":
                raise AnalysisError(f"the scheduler at {self.scheduler} is gone; start it again")
            elif not isinstance(error := future.exception(), distributed.KilledWorker):
                raise AnalysisError(f"a worker of {self.scheduler} failed: {error!r}")
            elif chunk.numbers.size == 1:
                yield [self.task.failed(int(chunk.numbers[0]), DIED)]
            else:
                running.update([submit(single) for single in chunk.split()])
