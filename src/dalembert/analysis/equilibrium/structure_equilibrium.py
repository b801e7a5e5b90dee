"""Equilibria of a structure under its load cases, each reached by load steps from rest."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.equilibrium.load_steps import LoadSteps, StepControl
from dalembert.analysis.equilibrium.stability import equilibrium_text, instability_warnings
from dalembert.analysis.equilibrium.static_equations import StaticEquations
from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult
from dalembert.timing import Timing

BEYOND = (
    "the load is beyond a bifurcation or limit point, and the structure moves to another "
    "equilibrium; solve_buckling and solve_load_path locate that point, a small transverse load "
    "or an imperfection leads to the stable path"
)


def structure_equilibrium(
    analysis: Any, model: StructuralModel, p: np.ndarray, progress: Reported = False
) -> StructuralResult:
    """Equilibria ``∂W/∂u (U, p) = P`` with ``U_p`` prescribed, one for each load case.

    A failed run keeps the last equilibria.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Equilibrium``
    """
    timing, control = Timing(), StepControl.of(analysis)
    paths = [LoadSteps(control, StaticEquations(model, p, case)) for case in model.loads]
    interrupted = False
    try:
        with progress_reporter(progress, f"loading {model.name}") as report:
            for k, path in enumerate(paths):
                for share in path.follow():
                    report((k + share) / len(paths))
    except KeyboardInterrupt:
        interrupted = True
    timing.lap("loading")
    ends = [path.end() for path in paths]
    timing.lap("outputs")
    warnings: list[str] = []
    for path, end in zip(paths, ends, strict=True):
        where = f"load case {path.case!r}" if path.case else "the load"
        warnings += instability_warnings(end.record.negative, BEYOND, where)
    residual, iterations = max(end.residual for end in ends), sum(p.iterations for p in paths)
    factors = [end.record.factor for end in ends if end.record.factor is not None]
    statistics: dict[str, Any] = {
        "iterations": iterations,
        "stable": not warnings,
        "residual [N or N m]": residual,
        "factorisations": iterations + len(factors),
        "solver": factors[0].name if factors else "none",
        "build time [s]": round(model.build_time, 6),
        **timing.statistics,
    }
    worst = min(paths, key=lambda path: path.reached)
    outcome, text = Outcome.COMPLETED, equilibrium_text(residual, iterations, not warnings)
    if interrupted:
        outcome = Outcome.INTERRUPTED
        text = f"load case {worst.case!r}: stopped at {worst.reached:.4g} of the load"
    elif worst.failure:
        outcome, text = Outcome.NOT_CONVERGED, f"{worst.failure} or take more steps"
    return StructuralResult(
        model,
        analysis,
        p,
        list(model.loads),
        np.stack([path.u for path in paths], axis=1),
        np.stack([end.forces for end in ends], axis=1),
        Status(outcome, text, worst.reached, max(path.residual for path in paths)),
        statistics,
        [end.record for end in ends],
        warnings,
    )
