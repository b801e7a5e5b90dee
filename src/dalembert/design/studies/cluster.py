"""Designs on a Dask cluster."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from dalembert.design.studies.task import Answer, StudyTask
from dalembert.design.studies.workers import DIED, Chunk, answer_chunk
from dalembert.errors import AnalysisError, UnsupportedError

_tasks: dict[str, StudyTask] = {}
"""Of this worker: one of each study, as making it costs more than a design."""
WAIT = 5.0
"""For the scheduler to answer [s]."""
_one_at_a_time = threading.Lock()
"""Compiled functions are not shared between the threads of a worker."""


def answer_there(identity: str, make: Callable[[], StudyTask], chunk: Chunk) -> list[Answer]:
    """On a worker: the task, made once, and its answers."""
    with _one_at_a_time:
        if identity not in _tasks:
            _tasks.clear()
            _tasks[identity] = make()
        return answer_chunk(_tasks[identity], chunk)


@dataclass(frozen=True, eq=False)
class Cluster:
    """The workers of a Dask scheduler; one that dies, Dask replaces by another.

    Parameters
    ----------
    scheduler : its address, such as ``tcp://host:8786``
    make : makes the task on each worker
    task : made here
    identity : of the study
    """

    scheduler: str
    make: Callable[[], StudyTask]
    task: StudyTask
    identity: str

    def answers(self, chunks: Sequence[Chunk]) -> Iterator[list[Answer]]:
        distributed = _distributed()
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
        def give(chunk: Chunk) -> Any:
            future = client.submit(answer_there, self.identity, self.make, chunk, pure=False)
            given[future.key] = chunk
            return future

        given: dict[str, Chunk] = {}
        running = distributed.as_completed([give(chunk) for chunk in chunks], loop=client.loop)
        for future in running:
            chunk = given.pop(future.key)
            if future.status == "finished":
                yield future.result()
            elif future.status != "error" and client.status == "running":
                running.add(give(chunk))  # forgotten with the worker that had it
            elif future.status != "error":
                raise AnalysisError(f"the scheduler at {self.scheduler} is gone; start it again")
            elif not isinstance(error := future.exception(), distributed.KilledWorker):
                raise AnalysisError(f"a worker of {self.scheduler} cannot work: {error!r}")
            elif chunk.numbers.size == 1:
                yield [self.task.failed(int(chunk.numbers[0]), DIED)]
            else:
                running.update([give(one) for one in chunk.parted()])


def _distributed() -> Any:
    try:
        import distributed
    except ImportError:
        raise UnsupportedError(
            "a study on a cluster needs dask.distributed: pip install 'dalembert[cluster]'"
        ) from None
    return distributed
