"""``dalembert optimize``: the best parameters for a response of a model file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import (
    DONE,
    FAILED,
    INTERRUPTED,
    AsJson,
    Quiet,
    Settings,
    emit,
    tell,
    written,
    wrong_input,
)
from dalembert.cli.loading import loaded, output_folder

if TYPE_CHECKING:
    from dalembert.design.optimum import Optimum


def optimize(
    model: Path,
    /,
    *,
    output: Path | None = None,
    history: Path | None = None,
    settings: Settings | None = None,
    quiet: Annotated[Quiet, Parameter(help="Do not print the iterations.")] = False,
    as_json: AsJson = False,
) -> int:
    """Find the parameter values that make a response of a model file best.

    Parameters
    ----------
    model
        Model file with [analysis], [responses] and [optimize].
    output
        Folder for the motion of the best design (.optimum.nc and .optimum.report.html); none is
        written by default.
    history
        File in which all designs run are kept; the same call goes on from it after an interrupt.
    """
    from dalembert.design.optimization import optimize as best_of
    from dalembert.io.analyses import make_analysis
    from dalembert.io.tasks import make_design, report_choices

    file, built = loaded(model, settings)
    with wrong_input():
        task = make_analysis(file, built)
        design = make_design(file, built)
        choices = report_choices(file, built)
    folder = output_folder(output) if output else None

    def tell(number: int, objective: float) -> None:
        print(f"iteration {number}: {objective:.8g}", file=sys.stderr)

    silent = quiet or as_json
    best = best_of(
        built, **design, analysis=task, history=history, progress=False if silent else tell
    )
    files: list[Path] = []
    if folder is not None:
        base = folder / f"{file.path.stem}.optimum"
        files = best.motion.write(base, False, False, **choices)
        if best.motion.has_page:
            files.append(best.report(base.with_name(f"{base.name}.report.html"), **choices))
    made = _document(best, files)
    if as_json:
        emit(made)
    else:
        _print(file.name, made)
    if best.interrupted:
        return INTERRUPTED
    return DONE if best.success else FAILED


def _document(best: Optimum, files: list[Path]) -> dict[str, Any]:
    return {
        "ok": best.success,
        "message": best.message,
        "x": best.x,
        "fun": best.fun,
        "objective": best.label,
        "unit": best.unit,
        "start": best.history[0].parameters,
        "start_fun": best.history[0].objective,
        "gradient": best.gradient,
        "violation": best.violation,
        "at_bounds": best.at_bounds,
        "active": best.active,
        "prices": best.prices,
        "stationarity": best.stationarity,
        "iterations": len(best.history) - 1,
        "runs": best.runs,
        "gradients": best.gradients,
        "failed_runs": best.failed_runs,
        "history": [
            {"parameters": i.parameters, "objective": i.objective, "violation": i.violation}
            for i in best.history
        ],
        "files": [str(f) for f in files],
    }


def _print(name: str, made: dict[str, Any]) -> None:
    style = "green" if made["ok"] else "red"
    tell(f"{name}: {made['message']}", style)
    change = f"{made['start_fun']:.8g} → {made['fun']:.8g} {made['unit']}".rstrip()
    tell(f"  objective {made['objective']}  {change}")
    for parameter, value in made["x"].items():
        note = "  (at its bound)" if parameter in made["at_bounds"] else ""
        start = made["start"][parameter]
        tell(f"  {parameter:<10} {start:.8g} → {value:.8g}{note}")
    if made["active"]:
        tell(f"  limits that hold with equality: {', '.join(made['active'])}")
    for price in made["prices"]:
        tell(f"  {price}")
    if made["violation"] > 0:
        tell(f"  largest relative violation of a limit: {made['violation']:.3g}")
    failed = f", {made['failed_runs']} failed" if made["failed_runs"] else ""
    tell(f"  {made['iterations']} iterations, {made['runs']} runs{failed}")
    written(made["files"])
