"""Execution of an analysis for one design or for many."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.individual_runs import IndividualRuns
from dalembert.analysis.batch.states import States
from dalembert.analysis.elastic_range import (
    coordinates_of,
    elastic_warnings as design_warnings,
    strains_of,
)
from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.model.graph.model import Model
from dalembert.processes import checked_workers
from dalembert.results.analysis import Analysis
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.designs import Designs, are_designs
from dalembert.results.batch.samples import Gathered
from dalembert.results.recording import Trajectory
from dalembert.results.result import Result
from dalembert.symbolic.once import once
from dalembert.symbolic.parametric_model import ParametricModel


def run_analysis(
    analysis: Analysis[Any, Any],
    model: ParametricModel,
    parameters: Any,
    progress: Reported = False,
    workers: int | None = None,
) -> Any:
    """The result of an analysis, or a batch of results for many designs."""
    count = checked_workers(workers)
    if not are_designs(parameters):
        return analysis.run(model, parameters, progress)  # type: ignore[call-arg]
    return solve_batch(analysis, model, Designs.of(model, parameters), progress, count)


def _together(analysis: Any, model: Any) -> bool:
    """Whether designs are computed at once."""
    if model.kind != "mechanism" or analysis.batched is None:
        return False
    return bool(analysis.batched.serves(analysis, model))


def solve_batch(
    analysis: Analysis[Any, Any],
    model: ParametricModel,
    designs: Designs,
    progress: Reported,
    workers: int,
) -> Batch:
    """The batch of all designs, with the status of each.

    Raises
    ------
    DalembertError
        No design could begin, all for the same reason.
    """
    analysis = analysis.for_model(model).for_designs()
    if times := analysis.checks(model).get("duration"):
        times()
    begin = clock.perf_counter()
    with progress_reporter(progress, f"{len(designs)} designs of {model.name}") as report:
        if _together(analysis, model):
            batch: Batch = analysis.batched(analysis, model, designs, workers).execute(report)
            states = batch.samples if isinstance(batch.samples, States) else None
            elastic = elastic_warnings(states) if states is not None else []
            warnings = [*batch.warnings, *elastic, *warnings_of(batch.results)]
            batch.warnings = list(dict.fromkeys(warnings))
            return batch
        runs = IndividualRuns(analysis, model, designs)
        runs.run(range(len(designs)), workers, report)
    statuses = [runs.statuses[k] for k in range(len(designs))]
    messages = {status.message for status in statuses}
    if not runs.results and len(messages) == 1 and runs.errors:
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
    """Warnings of individually run designs: those of the first, and their number."""
    warned = [k for k in sorted(results) if results[k].warnings]
    if not warned:
        return []
    texts = [f"design {warned[0]}: {text}" for text in results[warned[0]].warnings]
    summary = f"{len(warned)} of {len(results)} individually run designs have warnings"
    return [*texts, summary] if len(warned) > 1 else texts


def elastic_warnings(states: States) -> list[str]:
    """Warnings of the designs with the largest displacements and strains of elastic bodies.

    Parameters
    ----------
    states : States of all designs at the outputs; NaN where there are none
    """
    model, finished = states.model, np.flatnonzero(np.isfinite(states.x[:, :1, 0]).all(axis=1))
    if not (finished.size and states.time.size and (coordinates_of(model) or strains_of(model))):
        return []
    sizes, y = states.evaluate(_sizes(model, states.bodies), finished, np.arange(states.time.size))
    largest = np.nanmax(sizes, axis=1, initial=0.0)  # (designs, bodies and beams)
    warnings = []
    for k in sorted({int(k) for k in np.argmax(largest, axis=0)}):
        empty = np.zeros((0, states.time.size))
        trajectory = Trajectory(states.time, y[k].T, empty, empty, empty, empty)
        texts = design_warnings(model, trajectory, states.p[finished[k]])
        warnings += [f"design {finished[k]}: {text}" for text in texts]
    return warnings


@once
def _sizes(model: Model, bodies: ca.Function) -> ca.Function:
    """``(t, x, p) → sizes, y``; sizes of flexible coordinates and of strains of beams."""
    t, x, p = bodies.sx_in()
    y = bodies.call([t, x, p])[0]
    coordinates = [ca.norm_inf(function(y)) for function in coordinates_of(model)]
    strains = [ca.mmax(function(t, y, p)[0]) for _, function in strains_of(model)]
    return ca.Function("sizes", [t, x, p], [ca.vertcat(*coordinates, *strains), y], {"cse": True})
