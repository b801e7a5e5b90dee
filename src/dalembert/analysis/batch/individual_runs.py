"""Individual runs of designs, in this process or in copies of it."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from dalembert.analysis.batch.states import States
from dalembert.errors import AnalysisError, AssemblyError, BudgetError, DalembertError
from dalembert.model.graph.model import Model
from dalembert.processes import can_copy, in_copies
from dalembert.results.analysis import Analysis
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.designs import Designs
from dalembert.results.batch.samples import match_instants
from dalembert.results.result import Result
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.parametric_model import ParametricModel

WORTH_COPYING = 0.15
"""Threshold of the remaining work for copies of this process [s]."""
SHARED = ("model", "analysis", "record")
"""Fields that results share, or that only a new run of a design needs."""
STOPPED = Status(Outcome.INTERRUPTED, "stopped before this design", 0.0, float("nan"))


def refusal(error: DalembertError) -> Status:
    """The status of a design that could not begin."""
    outcome = Outcome.NOT_ASSEMBLED if isinstance(error, AssemblyError) else Outcome.REFUSED
    residual = getattr(error, "residual", None)
    return Status(outcome, str(error), float("nan"), float("nan") if residual is None else residual)


@dataclass
class IndividualRuns:
    """Individual runs of designs with their results and statuses.

    Attributes
    ----------
    results : number of the design → its result without its record
    statuses : number of the design → Status
    errors : number of the design → error that prevented its start, if raised in this process
    """

    analysis: Analysis
    model: ParametricModel
    designs: Designs
    results: dict[int, Result] = field(default_factory=dict)
    statuses: dict[int, Status] = field(default_factory=dict)
    errors: dict[int, DalembertError] = field(default_factory=dict)

    def run(self, numbers: Sequence[int], workers: int, report: Callable[[float], None]) -> None:
        """Run these designs; an interruption keeps the finished ones."""
        waiting = list(numbers)
        try:
            while waiting and (not self.results or not self._worth_copying(waiting, workers)):
                begin = clock.perf_counter()
                self._run_here(waiting.pop(0))
                self._lasted = clock.perf_counter() - begin
                report(1 - len(waiting) / len(numbers))
            if waiting:
                for k, (result, status) in in_copies(self._run_in_copy, waiting, workers):
                    self._store(k, result, status)
                    report(len(self.statuses) / len(numbers))
            for k in waiting:
                if k not in self.statuses:
                    self._run_here(k)
        except KeyboardInterrupt:
            pass
        for k in numbers:
            self.statuses.setdefault(k, STOPPED)

    def _worth_copying(self, waiting: list[int], workers: int) -> bool:
        """Whether copies of this process run the rest; all functions are compiled."""
        if any(result.needs_record for result in self.results.values()):
            return False
        worth = self._lasted * len(waiting) > WORTH_COPYING
        return workers > 1 and len(waiting) > 1 and worth and can_copy()

    def _run_here(self, k: int) -> None:
        result, status = self._run_design(k)
        if result is not None and status.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        self._store(k, result, status)

    def _store(self, k: int, result: Any, status: Status) -> None:
        self.statuses[k] = status
        if result is None:
            return
        first: Any = next(iter(self.results.values()), result)
        for name in SHARED:
            if getattr(result, name, None) is None:
                setattr(result, name, None if name == "record" else getattr(first, name))
        self._refuse_other_times(first, result)
        self.results[k] = result

    def _refuse_other_times(self, reference: Any, result: Any) -> None:
        outcomes = {reference.status.outcome, result.status.outcome}
        if reference is result or outcomes != {Outcome.COMPLETED}:
            return
        expected, times = reference.time, result.time
        if expected.shape != times.shape or np.any(match_instants(expected, times) < 0):
            raise AnalysisError(self.analysis.different_samples)

    def _run_design(self, k: int) -> tuple[Any, Status]:
        """Result without its record, None where it could not begin, and status of a design."""
        try:
            result: Any = self.analysis.run(self.model, self.designs.named(k))
        except BudgetError:
            raise
        except DalembertError as error:
            self.errors[k] = error
            return None, refusal(error)
        if result.needs_record:
            return result, result.status
        stored = copy(result)
        stored.record = None
        return stored, result.status

    def _run_in_copy(self, k: int) -> tuple[Any, Status]:
        """The same without fields that the other process has."""
        result, status = self._run_design(k)
        if result is not None:
            names = {f.name for f in fields(result)}
            for name in SHARED:
                if name in names:
                    setattr(result, name, None)
        return result, status


def completed_batch(
    task: tuple[Any, Model, Designs, int],
    states: States,
    statuses: dict[int, Status],
    interrupted: bool,
    statistics: Mapping[str, Any],
    begin: float,
) -> Batch:
    """The batch, after individual runs of all designs without a status.

    Parameters
    ----------
    task : analysis, model, designs and workers
    states : states of the successful designs
    statuses : number of the design → Status of the designs run so far
    interrupted : no further design is run
    statistics : additional entries of the statistics
    begin : clock time of the begin of the batch [s]

    Raises
    ------
    DalembertError
        No design could begin, all for the same reason.
    """
    analysis, model, designs, workers = task
    count = len(designs)
    successful = [k for k, status in statuses.items() if status.success]
    states.x[np.setdiff1d(np.arange(count), successful)] = np.nan
    runs = IndividualRuns(analysis, model, designs)
    waiting = [k for k in range(count) if k not in statuses]
    if not interrupted:
        runs.run(waiting, workers, lambda fraction: None)
    for k in waiting:
        statuses[k] = runs.statuses.get(k, STOPPED)
    states.individual = runs.results
    if len(runs.errors) == count and len({s.message for s in statuses.values()}) == 1:
        raise next(iter(runs.errors.values()))
    entries = {
        "workers": workers,
        **statistics,
        "designs run on their own": len(waiting),
        "computation time [s]": round(clock.perf_counter() - begin, 6),
    }
    in_order = [statuses[k] for k in range(count)]
    return Batch(model, analysis, designs, in_order, states, runs.results, entries)
