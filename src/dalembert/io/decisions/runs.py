"""Design tasks of a file as functions that run them, for the command line and the studio."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.io.analyses import make_analysis
from dalembert.io.model_file import ModelFile

if TYPE_CHECKING:
    from dalembert.design.decision import Decision

Run = Callable[[Any], "Decision"]
"""Runs a task; the argument is ``progress`` of its function."""


def optimization(file: ModelFile, model: Any, history: Path | None = None) -> Run:
    """``[optimize]``; with ``beta`` the reliability-based optimisation.

    Parameters
    ----------
    history : file that records all evaluated designs
    """
    from dalembert.design.optimize.optimization import optimize
    from dalembert.design.reliability.optimize_reliable import optimize_reliable
    from dalembert.io.decisions.designs import make_design

    design = make_design(file, model)
    design["analysis"] = make_analysis(file, model)
    search: Callable[..., Any] = optimize_reliable if "beta" in design else optimize
    return lambda progress: search(model, **design, history=history, progress=progress)


def front(file: ModelFile, model: Any) -> Run:
    """``[pareto]``."""
    from dalembert.design.pareto.pareto import pareto
    from dalembert.io.decisions.designs import make_front

    arguments, analysis = make_front(file, model), make_analysis(file, model)
    return lambda progress: pareto(model, **arguments, analysis=analysis, progress=progress)


def scatter(file: ModelFile, model: Any) -> Run:
    """``[tolerance]``, with its allocation."""
    from dalembert.design.tolerance.tolerance import tolerance
    from dalembert.io.decisions.reliability import make_tolerance

    arguments, allocation = make_tolerance(file, model)
    analysis = make_analysis(file, model)

    def run(progress: Any) -> Decision:
        decision = tolerance(model, **arguments, analysis=analysis, progress=progress)
        if allocation is not None:
            with file.located("tolerance", "allocate"):
                decision.allocated = decision.allocate(**allocation)
        return decision

    return run


def failure_probability(file: ModelFile, model: Any) -> Run:
    """``[reliability]``."""
    from dalembert.design.reliability.reliability import reliability
    from dalembert.io.decisions.reliability import make_reliability

    arguments, analysis = make_reliability(file, model), make_analysis(file, model)
    return lambda progress: reliability(model, **arguments, analysis=analysis, progress=progress)


def identification(file: ModelFile, model: Any, data: Sequence[Path] | None = None) -> Run:
    """``[identify]``.

    Parameters
    ----------
    data : files of measurements instead of those of the file
    """
    from dalembert.design.identification.identify import identify
    from dalembert.io.decisions.estimation import check_files, make_identification

    arguments = make_identification(file, model, list(data) if data else None)
    analysis = make_analysis(file, model) if file.document.analysis is not None else None
    check_files([experiment.data for experiment in arguments["data"]])
    return lambda progress: identify(model, **arguments, analysis=analysis, progress=progress)


def study(file: ModelFile, model: Any) -> Run:
    """``[sweep]`` in this process; nothing is written."""
    from dalembert.design.studies.sweep import sweep
    from dalembert.io.decisions.tasks import make_sweep

    design, responses = make_sweep(file, model)
    options = {"analysis": make_analysis(file, model), "responses": responses}
    return lambda progress: sweep(model, design, **options, progress=progress)


def synthesis(file: ModelFile, model: Any = None) -> Run:
    """``[synthesis]``."""
    from dalembert.io.decisions.synthesis import make_synthesis

    search = make_synthesis(file, model)

    def run(progress: Any) -> Decision:
        with file.located("synthesis"):
            candidates = search(progress=progress)
        candidates.name = file.name
        return candidates  # type: ignore[no-any-return]

    return run


RUNS: dict[str, Callable[[ModelFile, Any], Run]] = {
    "optimize": optimization,
    "pareto": front,
    "tolerance": scatter,
    "reliability": failure_probability,
    "identify": identification,
    "sweep": study,
    "synthesis": synthesis,
}
"""Section of a file → its run."""
