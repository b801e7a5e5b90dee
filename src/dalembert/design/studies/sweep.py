"""A model run at many designs."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.design.studies.cluster import Cluster
from dalembert.design.studies.design import Design
from dalembert.design.studies.folder import StudyFolder
from dalembert.design.studies.study import Study
from dalembert.design.studies.task import Answer, StudyTask
from dalembert.design.studies.workers import Chunk, Here, Processes, Workers
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.responses.base import Response
from dalembert.responses.several import as_responses
from dalembert.results.result import Analysis
from dalembert.results.warnings import Warnings
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.spelling import spelled

ModelSource = ParametricModel | Callable[[], ParametricModel]
LARGEST_CHUNK = 256
LEAST_BATCH = 128
"""Designs that are run side by side at once, where there are so many."""
CHECKED = 4
"""Upper limit of designs that run again on their own for their warnings."""


@spelled
def sweep(
    model: ModelSource,
    design: Design,
    *,
    analysis: Analysis,
    responses: Response | Sequence[Response],
    folder: str | Path | None = None,
    workers: int | None = 1,
    scheduler: str | None = None,
    chunk: int | None = None,
    progress: Reported = False,
) -> Study:
    """Responses of an analysis at many designs; those that fail are kept with their reason.

    Parameters
    ----------
    model : a model, or a function that makes one; a cluster needs the function
    design : ``Design.grid``, ``.latin_hypercube``, ``.sobol``, ``.monte_carlo`` or ``.table``
    analysis : ``Dynamics(...)``, ``Kinematics(...)`` and so on
    responses : what is kept of each run
    folder : where answers are written as they come; a study that was ended, even killed, goes on
        there, with any number of workers; Parquet, without pyarrow CSV
    workers : processes; None for all cores
    scheduler : address of a Dask scheduler, instead of processes here
    chunk : designs that a worker is given at once
    progress : True for a bar with the time left, or a function of the fraction done

    Raises
    ------
    AnalysisError
        No such response, or no scheduler at the address.
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
    >>> grid = da.Design.grid({"k": [10.0, 20.0, 50.0]})
    >>> study = da.sweep(spring.build(), grid, analysis=da.Statics(), responses=da.final("end.ux"))
    >>> study.values[:, 0].round(6)  # F/k
    array([10.,  5.,  2.])
    """
    make = _maker(model, analysis, as_responses(responses), scheduler)
    return run_study(make, design, folder, workers, scheduler, chunk, progress)


def run_study(
    make: Callable[[], StudyTask],
    design: Design,
    folder: str | Path | None = None,
    workers: int | None = 1,
    scheduler: str | None = None,
    chunk: int | None = None,
    progress: Reported = False,
) -> Study:
    """``sweep`` of a task that is made here and, on a cluster, by every worker."""
    check_counts(workers, chunk)
    task = make()
    task.check(design)
    identity = task.identity(design)
    count = _workers(workers)
    place: Workers
    if scheduler is not None:
        place = Cluster(scheduler, make, task, identity)
    else:
        place = Here(task) if count == 1 else Processes(make, task, count)
    size = chunk or _size(task, len(design), count)
    labels = [response.label for response in task.responses]
    about = {"model": task.model.name, "designs": len(design), "responses": labels}
    kept = None if folder is None else StudyFolder(folder, identity, about)
    try:
        found = kept.answers() if kept else {}
        reused = len(found)
        with progress_reporter(progress, "sweep") as report:
            for answers in place.answers(_chunks(design, found, size)):
                if kept:
                    kept.add(answers)
                found.update((a.number, a) for a in answers)
                report(len(found) / len(design))
        study = _study(task, design, tuple(labels), found, folder, reused)
        if kept:
            study = replace(study, stored=kept.finish(study.columns))
    finally:
        if kept:
            kept.close()
    return study


def _study(
    task: StudyTask,
    design: Design,
    labels: tuple[str, ...],
    found: dict[int, Answer],
    folder: str | Path | None,
    reused: int,
) -> Study:
    listed = [found[k] for k in range(len(design))]
    values = np.array([a.values for a in listed])
    reasons = tuple(a.reason for a in listed)
    where = None if folder is None else Path(folder)
    warnings = Warnings(deferred=lambda: task.warnings(design, _extreme_designs(values)))
    return Study(
        task.model.name,
        design,
        labels,
        values,
        reasons,
        where,
        reused,
        task.units,
        warnings=warnings,
    )


def _extreme_designs(values: np.ndarray) -> list[int]:
    """Designs with the smallest and largest values of the responses, at most ``CHECKED``."""
    columns = [column for column in values.T if np.isfinite(column).any()]
    extremes = [pick(column) for column in columns for pick in (np.nanargmin, np.nanargmax)]
    return [int(k) for k in dict.fromkeys(extremes)][:CHECKED]


def _chunks(design: Design, done: dict[int, Answer], size: int) -> list[Chunk]:
    """What is left to do, in pieces."""
    left = np.array([k for k in range(len(design)) if k not in done], dtype=int)
    pieces = [left[k : k + size] for k in range(0, left.size, size)]
    return [Chunk(piece, design.names, design.values[piece]) for piece in pieces]


def _size(task: StudyTask, designs: int, count: int) -> int:
    """Designs of a chunk: enough that a batch is worth it, few enough that answers keep coming."""
    even = max(1, min(LARGEST_CHUNK, designs // (16 * count)))
    return max(even, min(LEAST_BATCH, -(-designs // count))) if task.batched else even


def check_counts(workers: int | None, chunk: int | None) -> None:
    """Refuse numbers of processes or designs that are none.

    Raises
    ------
    AnalysisError
        With the name of the argument.
    """
    counts = ("workers", "processes", workers), ("chunk", "designs given out at once", chunk)
    for name, what, count in counts:
        if count is None:
            continue
        if not isinstance(count, int) or isinstance(count, bool) or count < 1:
            raise AnalysisError(f"{name} is a number of {what}, at least 1, got {count!r:.30}")


def _workers(count: int | None) -> int:
    if count is None:
        return (
            len(os.sched_getaffinity(0))
            if hasattr(os, "sched_getaffinity")
            else os.cpu_count() or 1
        )
    return count


class _Maker:
    """Makes the task from a function that makes the model; can be sent to other processes."""

    def __init__(
        self, model: Callable[[], ParametricModel], analysis: Analysis, responses: list[Response]
    ):
        self.model, self.analysis, self.responses = model, analysis, responses

    def __call__(self) -> StudyTask:
        return StudyTask(self.model(), self.analysis, self.responses)


def _maker(
    model: ModelSource, analysis: Analysis, responses: list[Response], scheduler: str | None
) -> Callable[[], StudyTask]:
    if not isinstance(model, ParametricModel):
        if not callable(model):
            raise AnalysisError(f"{model!r:.60} is neither a model nor a function that makes one")
        return _Maker(model, analysis, responses)
    if scheduler is not None:
        raise UnsupportedError(
            "a built model cannot be sent to other machines; give a function that makes it, "
            "da.sweep(make_model, ...)"
        )
    return lambda: StudyTask(model, analysis, responses)
