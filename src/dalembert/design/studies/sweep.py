"""Parameter sweep: an analysis at many designs."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.design.studies.design_table import DesignTable
from dalembert.design.studies.folder import StudyFolder
from dalembert.design.studies.sweep_result import SweepResult
from dalembert.design.studies.task import Answer, StudyTask
from dalembert.design.studies.workers import Chunk, Cluster, InProcess, Processes, Workers
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.interrupts import check_ctrl_c, ctrl_c, searching
from dalembert.responses.base import Response
from dalembert.responses.evaluation import as_responses
from dalembert.results.analysis import Analysis
from dalembert.results.status import Warnings
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_arguments

ModelSource = ParametricModel | Callable[[], ParametricModel]
MAX_CHUNK = 256
"""Upper limit of the designs of a chunk."""
MIN_BATCH = 128
"""Lower limit of the designs of a batch, if there are enough designs."""
CHECKED = 4
"""Upper limit of the designs that are run again for their warnings."""
INTERRUPTED = "interrupted"
"""Reason of the designs that did not run before Ctrl-C."""


@check_arguments
def sweep(
    model: ModelSource,
    design: DesignTable,
    *,
    analysis: Analysis,
    responses: Response | Sequence[Response],
    folder: str | Path | None = None,
    workers: int | None = 1,
    scheduler: str | None = None,
    chunk: int | None = None,
    progress: Reported = False,
) -> SweepResult:
    """Run an analysis at many designs; failures are stored with their reasons.

    Ctrl-C keeps the finished designs; the reason of the others is ``interrupted``.

    Parameters
    ----------
    model : a model, or a function that builds one; a cluster needs the function
    design : ``DesignTable.grid``, ``.latin_hypercube``, ``.sobol``, ``.monte_carlo`` or ``.table``
    analysis : ``Dynamics(...)``, ``Kinematics(...)`` and so on
    responses : evaluated in each run
    folder : folder for the answers; an interrupted or killed study resumes from it, with any
        number of workers; Parquet, or CSV without pyarrow
    workers : number of processes; None for all cores
    scheduler : address of a Dask scheduler, instead of local processes
    chunk : designs per chunk of work
    progress : True for a bar with the remaining time, or a function of the fraction done

    Raises
    ------
    AnalysisError
        Unknown response, or no scheduler at the address.
    FileError
        The folder holds another study.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> k = spring.parameter("k", 50.0, bounds=(1, 1e3))
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> spring.load(end, fx=100.0)
    >>> grid = da.DesignTable.grid({"k": [10.0, 20.0, 50.0]})
    >>> study = da.sweep(spring.build(), grid, analysis=da.Statics(), responses=da.final("end.ux"))
    >>> study.values[:, 0].round(6)  # F/k
    array([10.,  5.,  2.])
    """
    make = _task_maker(model, analysis, as_responses(responses), scheduler)
    return run_study(make, design, folder, workers, scheduler, chunk, progress)


def run_study(
    make: Callable[[], StudyTask],
    design: DesignTable,
    folder: str | Path | None = None,
    workers: int | None = 1,
    scheduler: str | None = None,
    chunk: int | None = None,
    progress: Reported = False,
) -> SweepResult:
    """Run a study whose task is built here and, on a cluster, by every worker."""
    check_counts(workers, chunk)
    task = make()
    task.check(design)
    identity = task.identity(design)
    count = _worker_count(workers)
    backend: Workers
    if scheduler is not None:
        backend = Cluster(scheduler, make, task, identity)
    else:
        backend = InProcess(task) if count == 1 else Processes(make, task, count)
    size = chunk or _chunk_size(task, len(design), count)
    labels = [response.label for response in task.responses]
    description = {"model": task.model.name, "designs": len(design), "responses": labels}
    storage = None if folder is None else StudyFolder(folder, identity, description)
    try:
        answered = storage.answers() if storage else {}
        reused = len(answered)
        with ctrl_c():
            try:
                with searching(), progress_reporter(progress, "sweep") as report:
                    for answers in backend.answers(_chunks(design, answered, size)):
                        if storage:
                            storage.add(answers)
                        answered.update((answer.number, answer) for answer in answers)
                        report(len(answered) / len(design))
                        check_ctrl_c()
            except KeyboardInterrupt:
                if not answered:
                    raise
            interrupted = len(answered) < len(design)
        study = _make_study(task, design, tuple(labels), answered, folder, reused, interrupted)
        if storage and not interrupted:
            study = replace(study, table_path=storage.finish(study.columns))
    finally:
        if storage:
            storage.close()
    return study


def _make_study(
    task: StudyTask,
    design: DesignTable,
    labels: tuple[str, ...],
    answers: dict[int, Answer],
    folder: str | Path | None,
    reused: int,
    interrupted: bool,
) -> SweepResult:
    ordered = [answers.get(k) or task.failed(k, INTERRUPTED) for k in range(len(design))]
    values = np.array([answer.values for answer in ordered])
    reasons = tuple(answer.reason for answer in ordered)
    path = None if folder is None else Path(folder)
    warnings = Warnings(deferred=lambda: task.warnings(design, _extreme_designs(values)))
    return SweepResult(
        task.model.name,
        design,
        labels,
        values,
        reasons,
        path,
        reused,
        task.units,
        warnings=warnings,
        task=task,
        interrupted=interrupted,
    )


def _extreme_designs(values: np.ndarray) -> list[int]:
    """Designs with the smallest and largest values of the responses, at most ``CHECKED``."""
    columns = [column for column in values.T if np.isfinite(column).any()]
    extremes = [pick(column) for column in columns for pick in (np.nanargmin, np.nanargmax)]
    return [int(k) for k in dict.fromkeys(extremes)][:CHECKED]


def _chunks(design: DesignTable, answered: dict[int, Answer], size: int) -> list[Chunk]:
    """Chunks of the designs without answers."""
    pending = np.array([k for k in range(len(design)) if k not in answered], dtype=int)
    pieces = [pending[k : k + size] for k in range(0, pending.size, size)]
    return [Chunk(piece, design.names, design.values[piece]) for piece in pieces]


def _chunk_size(task: StudyTask, designs: int, count: int) -> int:
    """Designs per chunk: enough for efficient batches, few enough for frequent answers."""
    size = max(1, min(MAX_CHUNK, designs // (16 * count)))
    return max(size, min(MIN_BATCH, -(-designs // count))) if task.batched else size


def check_counts(workers: int | None, chunk: int | None) -> None:
    """Refuse invalid numbers of processes or designs.

    Raises
    ------
    AnalysisError
        An argument is not a positive integer.
    """
    counts = ("workers", "processes", workers), ("chunk", "designs per chunk", chunk)
    for name, noun, count in counts:
        if count is None:
            continue
        if not isinstance(count, int) or isinstance(count, bool) or count < 1:
            raise AnalysisError(f"{name} is a number of {noun}, at least 1, got {count!r:.30}")


def _worker_count(count: int | None) -> int:
    if count is None:
        return (
            len(os.sched_getaffinity(0))
            if hasattr(os, "sched_getaffinity")
            else os.cpu_count() or 1
        )
    return count


class _TaskMaker:
    """Picklable function that builds the task from a function that builds the model."""

    def __init__(
        self, model: Callable[[], ParametricModel], analysis: Analysis, responses: list[Response]
    ):
        self.model, self.analysis, self.responses = model, analysis, responses

    def __call__(self) -> StudyTask:
        return StudyTask(self.model(), self.analysis, self.responses)


def _task_maker(
    model: ModelSource, analysis: Analysis, responses: list[Response], scheduler: str | None
) -> Callable[[], StudyTask]:
    if not isinstance(model, ParametricModel):
        if not callable(model):
            raise AnalysisError(f"{model!r:.60} is neither a model nor a function that builds one")
        return _TaskMaker(model, analysis, responses)
    if scheduler is not None:
        raise UnsupportedError(
            "a built model cannot be sent to other machines; give a function that builds it, "
            "da.sweep(make_model, ...)"
        )
    return lambda: StudyTask(model, analysis, responses)
