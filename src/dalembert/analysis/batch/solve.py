"""Running an analysis for one design or for many."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from typing import Any

from dalembert.analysis.batch.elastic_states import elastic_warnings_of_many
from dalembert.analysis.batch.one_by_one import OneByOne
from dalembert.analysis.batch.states import States
from dalembert.analysis.batch.workers import checked_workers
from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.designs import Designs, are_designs
from dalembert.results.batch.samples import Gathered
from dalembert.results.result import Analysis, Result
from dalembert.symbolic.parametric_model import ParametricModel


def run_analysis(
    analysis: Analysis[Any, Any],
    model: ParametricModel,
    parameters: Any,
    progress: Reported = False,
    workers: int | None = None,
) -> Any:
    """The result of an analysis, or a batch of them where many designs are given."""
    count = checked_workers(workers)
    if not are_designs(parameters):
        return analysis.run(model, parameters, progress)  # type: ignore[call-arg]
    return solve_batch(analysis, model, Designs.of(model, parameters), progress, count)


def solve_batch(
    analysis: Analysis[Any, Any],
    model: ParametricModel,
    designs: Designs,
    progress: Reported,
    workers: int,
) -> Batch:
    """All designs; those that fail are marked.

    Raises
    ------
    DalembertError
        No design could begin, and all for one reason, which then is none of theirs.
    """
    analysis = analysis.for_designs()
    if times := analysis.checks(model).get("duration"):
        times()
    begin = clock.perf_counter()
    with progress_reporter(progress, f"{len(designs)} designs of {model.name}") as report:
        if analysis.batched is not None and analysis.batched.serves(analysis, model):
            found: Batch = analysis.batched(analysis, model, designs, workers).execute(report)
            own = found.samples if isinstance(found.samples, States) else None
            more = elastic_warnings_of_many(own) if own is not None else []
            listed = [*found.warnings, *more, *warnings_of(found.results)]
            found.warnings = list(dict.fromkeys(listed))
            return found
        runs = OneByOne(analysis, model, designs)
        runs.run(range(len(designs)), workers, report)
    statuses = [runs.statuses[k] for k in range(len(designs))]
    alike = {status.message for status in statuses}
    if not runs.results and len(alike) == 1 and runs.errors:
        raise next(iter(runs.errors.values()))
    elapsed = clock.perf_counter() - begin
    return Batch(
        model,
        analysis,
        designs,
        statuses,
        Gathered(len(designs), runs.results),
        runs.results,
        {"workers": workers, "computation time [s]": round(elapsed, 6)},
        warnings_of(runs.results),
    )


def warnings_of(results: Mapping[int, Result]) -> list[str]:
    """Warnings of designs that ran on their own: those of the first, and how many have some."""
    warned = [k for k in sorted(results) if results[k].warnings]
    if not warned:
        return []
    found = [f"design {warned[0]}: {text}" for text in results[warned[0]].warnings]
    more = f"{len(warned)} of {len(results)} designs that ran on their own carry warnings"
    return [*found, more] if len(warned) > 1 else found
