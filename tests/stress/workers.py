"""Worker processes with a time limit and a memory limit for each case."""

from __future__ import annotations

import multiprocessing
import os
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait

from stress.verdict import Judge, Verdict

MEMORY = 8_000_000_000
"""Address space of a worker [bytes]."""
STARTING = 30.0
"""Seconds more for the first case of a worker, which imports everything."""
RENEWED = 200
"""Cases after which a worker is replaced, because models stay in memory for a while."""

Task = tuple[str, int]


def serve(pipe: Connection, judges: Callable[[str], Judge], memory: int) -> None:
    """Judge cases until the pipe is closed; runs in the worker."""
    if os.name == "posix":
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    devnull = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(devnull, stream)
    while True:
        try:
            family, seed = pipe.recv()
        except (EOFError, KeyboardInterrupt):
            return
        pipe.send(judged(family, seed, judges))


def judged(family: str, seed: int, judges: Callable[[str], Judge]) -> Verdict:
    """The verdict of a case in this process."""
    begin = time.perf_counter()
    try:
        kind, case, message = judges(family)(seed)
    except BaseException as error:  # whatever a case raises is a defect, ``SystemExit`` as well
        lines = traceback.format_exception(error)
        kind, case, message = "crash", "", "".join(lines)[-1500:]
    return Verdict(family, seed, kind, case, message[:3000], round(time.perf_counter() - begin, 3))


@dataclass
class Worker:
    """A process and the case that it judges."""

    process: multiprocessing.process.BaseProcess
    pipe: Connection
    task: Task | None = None
    deadline: float = 0.0
    cases: int = 0

    @classmethod
    def start(cls, judges: Callable[[str], Judge], memory: int) -> Worker:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=serve, args=(theirs, judges, memory), daemon=True)
        process.start()
        theirs.close()
        return cls(process, ours)

    def give(self, task: Task, limit: float) -> None:
        self.task, self.deadline = task, time.monotonic() + limit
        self.cases += 1
        self.pipe.send(task)

    def end(self) -> int | None:
        """Kill the process; its exit code."""
        self.process.kill()
        self.process.join()
        self.pipe.close()
        return self.process.exitcode


def verdicts(
    tasks: Iterable[Task],
    judges: Callable[[str], Judge],
    count: int = 1,
    limit: float = 120.0,
    memory: int = MEMORY,
) -> Iterator[Verdict]:
    """Verdicts of all tasks in the order in which they end.

    Parameters
    ----------
    judges : name of a family → its judge; imported by the workers
    count : of workers
    limit : wall time of a case [s]; beyond it is a hang
    """
    waiting = iter(tasks)
    workers: list[Worker] = []
    try:
        while True:
            idle = [w for w in workers if w.task is None]
            for task in _next(waiting, count - len(workers) + len(idle)):
                worker = idle.pop() if idle else Worker.start(judges, memory)
                if worker not in workers:
                    workers.append(worker)
                worker.give(task, limit + (STARTING if worker.cases == 0 else 0.0))
            busy = [w for w in workers if w.task is not None]
            if not busy:
                return
            for worker in _ready(busy):
                verdict = _received(worker, limit)
                worker.task = None
                if not worker.process.is_alive() or worker.cases >= RENEWED:
                    worker.end()
                    workers.remove(worker)
                yield verdict
    finally:
        for worker in workers:
            worker.end()


def _next(tasks: Iterator[Task], count: int) -> Iterator[Task]:
    for _ in range(count):
        task = next(tasks, None)
        if task is None:
            return
        yield task


def _ready(busy: list[Worker]) -> list[Worker]:
    """Workers with a verdict, dead ones and late ones."""
    patience = max(0.0, min(w.deadline for w in busy) - time.monotonic())
    wait([w.pipe for w in busy], timeout=patience)  # a dead process closes its end
    now = time.monotonic()
    return [w for w in busy if w.pipe.poll() or not w.process.is_alive() or now >= w.deadline]


def _received(worker: Worker, limit: float) -> Verdict:
    family, seed = worker.task or ("", 0)
    try:
        if worker.pipe.poll():
            return worker.pipe.recv()
    except (EOFError, OSError):
        worker.process.join(5)
        code = worker.process.exitcode
        return Verdict(family, seed, "crash", message=f"the process ended with exit code {code}")
    alive, code = worker.process.is_alive(), worker.end()
    if alive:
        return Verdict(family, seed, "hang", message=f"more than {limit:g} s", seconds=limit)
    return Verdict(family, seed, "crash", message=f"the process ended with exit code {code}")


def in_this_process(tasks: Iterable[Task], judges: Callable[[str], Judge]) -> Iterator[Verdict]:
    """The same without workers and limits, for debuggers."""
    for family, seed in tasks:
        print(f"{family} {seed}", file=sys.stderr, flush=True)
        yield judged(family, seed, judges)
