"""Evaluation of designs on a Dask cluster."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from dalembert.design.studies.task import Answer, StudyTask
from dalembert.design.studies.workers import DIED, Chunk, answer_chunk
from dalembert.errors import AnalysisError, UnsupportedError

_tasks: dict[str, StudyTask] = {}
"""Task of the current study on this worker, cached as it is expensive to build."""
WAIT = 5.0
"""Upper limit of the time to connect to the scheduler [s]."""
_task_lock = threading.Lock()
"""Serialises the threads of a worker, as compiled functions are not thread-safe."""


def answer_on_worker(identity: str, make: Callable[[], StudyTask], chunk: Chunk) -> list[Answer]:
    """Answers of a chunk, computed on a worker; builds the task once."""
    with _task_lock:
        if identity not in _tasks:
            _tasks.clear()
            _tasks[identity] = make()
        return answer_chunk(_tasks[identity], chunk)


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


def _distributed() -> Any:
    try:
        import distributed
    except ImportError:
        raise UnsupportedError(
            "a study on a cluster needs dask.distributed: pip install 'dalembert[cluster]'"
        ) from None
    return distributed
