"""Designs one by one: for analyses whose course depends on the design."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from dalembert.analysis.batch.workers import can_copy, in_copies
from dalembert.errors import AnalysisError, AssemblyError, BudgetError, DalembertError
from dalembert.results.batch.designs import Designs
from dalembert.results.batch.samples import match_instants
from dalembert.results.result import Analysis, Result
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.parametric_model import ParametricModel

WORTH_COPYING = 0.15
"""Seconds of work that are left from which it is shared with copies of this process."""
OWN = ("model", "analysis", "record")
"""What results have in common, or what only a new run of a design needs."""
STOPPED = Status(Outcome.INTERRUPTED, "stopped before this design", 0.0, float("nan"))


def refusal(error: DalembertError) -> Status:
    """The status of a design that could not begin."""
    outcome = Outcome.NOT_ASSEMBLED if isinstance(error, AssemblyError) else Outcome.REFUSED
    residual = getattr(error, "residual", None)
    return Status(outcome, str(error), float("nan"), float("nan") if residual is None else residual)


@dataclass
class OneByOne:
    """Runs of single designs, and what became of them.

    Attributes
    ----------
    results : number of the design → its result without its record
    statuses : number of the design → Status
    errors : number of the design → why it could not begin, where that is known here
    """

    analysis: Analysis
    model: ParametricModel
    designs: Designs
    results: dict[int, Result] = field(default_factory=dict)
    statuses: dict[int, Status] = field(default_factory=dict)
    errors: dict[int, DalembertError] = field(default_factory=dict)

    def run(self, numbers: Sequence[int], workers: int, report: Callable[[float], None]) -> None:
        """Run these designs; an interruption leaves those that are finished."""
        waiting = list(numbers)
        try:
            while waiting and (not self.results or not self._copying(waiting, workers)):
                begin = clock.perf_counter()
                self._here(waiting.pop(0))
                self._lasted = clock.perf_counter() - begin
                report(1 - len(waiting) / len(numbers))
            if waiting:
                for k, (result, status) in in_copies(self._sent, waiting, workers):
                    self._keep(k, result, status)
                    report(len(self.statuses) / len(numbers))
            for k in waiting:
                if k not in self.statuses:
                    self._here(k)
        except KeyboardInterrupt:
            pass
        for k in numbers:
            self.statuses.setdefault(k, STOPPED)

    def _copying(self, waiting: list[int], workers: int) -> bool:
        """Whether the rest is left to copies of this process; functions are compiled by now."""
        worth = self._lasted * len(waiting) > WORTH_COPYING
        return workers > 1 and len(waiting) > 1 and worth and can_copy()

    def _here(self, k: int) -> None:
        result, status = self._found(k)
        if result is not None and status.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        self._keep(k, result, status)

    def _keep(self, k: int, result: Any, status: Status) -> None:
        self.statuses[k] = status
        if result is None:
            return
        like: Any = next(iter(self.results.values()), result)
        for name in OWN:
            if getattr(result, name, None) is None:
                setattr(result, name, None if name == "record" else getattr(like, name))
        self._refuse_other_times(like, result)
        self.results[k] = result

    def _refuse_other_times(self, like: Any, result: Any) -> None:
        completed = Outcome.COMPLETED
        if not like.status.outcome is result.status.outcome is completed or like is result:
            return
        first, other = like.time, result.time
        if first.shape != other.shape or np.any(match_instants(first, other) < 0):
            raise AnalysisError(
                "the designs have outputs at different times, as steps with error control do; give "
                "the batch outputs, e.g. outputs=101"
            )

    def _found(self, k: int) -> tuple[Any, Status]:
        """The result of a design, or none, and how it ended."""
        try:
            result: Any = self.analysis.run(self.model, self.designs.named(k))
        except BudgetError:
            raise
        except DalembertError as error:
            self.errors[k] = error
            return None, refusal(error)
        kept = copy(result)
        kept.record = None
        return kept, result.status

    def _sent(self, k: int) -> tuple[Any, Status]:
        """The same without what the other process has."""
        result, status = self._found(k)
        if result is not None:
            names = {f.name for f in fields(result)}
            for name in OWN:
                if name in names:
                    setattr(result, name, None)
        return result, status
