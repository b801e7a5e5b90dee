"""Backends that evaluate the designs of a study: in-process, process pool or Dask cluster.

All yield the answers of chunks as they arrive, in any order. A chunk whose worker dies is submitted
again; a design that kills its worker even alone is recorded as failed.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np

from dalembert.design.studies.task import Answer, StudyTask
from dalembert.errors import AnalysisError
from dalembert.packages import optional_package
from dalembert.processes import ProcessPool

DIED = "the process that computed it died"
MAX_TRIES = 2
"""Runs of a single design whose worker dies until the design counts as failed."""
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
            answers = answer_chunk(self.task, chunk)
            yield answers
            if len(answers) < chunk.numbers.size:
                raise KeyboardInterrupt


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
        pending, pool = dict(enumerate(chunks)), self._pool(self.count)
        while pending:
            remaining = len(pending)
            for _, answers in pool.completed(pending):
                yield answers
            if len(pending) == remaining:  # one of the first submitted chunks kills its process
                for key in list(pending)[: pool.submitted]:
                    yield self._run_single(pending.pop(key))

    def _run_single(self, chunk: Chunk) -> list[Answer]:
        """Run designs one by one; a design that kills its process repeatedly fails."""
        return [answer for single in chunk.split() for answer in self._retry(single)]

    def _retry(self, chunk: Chunk) -> list[Answer]:
        for _ in range(MAX_TRIES):
            for _, answers in self._pool(1).completed({0: chunk}):
                return answers
        return [self.task.failed(int(chunk.numbers[0]), DIED)]

    def _pool(self, count: int) -> ProcessPool[Chunk, list[Answer]]:
        task, make = partial(answer_chunk, self.task), partial(_task_of_chunks, self.make)
        return ProcessPool(task, count, make)


def _task_of_chunks(make: Callable[[], StudyTask]) -> Callable[[Chunk], list[Answer]]:
    return partial(answer_chunk, make())


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
