"""``dalembert optimize``: parameter optimisation of a response of a model file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import print_line
from dalembert.cli.decision import NO_OPTIONS, DecisionCommand, Options, Run, iterations
from dalembert.text.wording import counted

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile

Names = Annotated[list[str] | None, Parameter(negative=())]


def optimize(
    model: Path,
    /,
    *,
    minimize: str | None = None,
    maximize: str | None = None,
    vary: Names = None,
    method: str | None = None,
    max_iterations: int | None = None,
    beta: float | None = None,
    output: Path | None = None,
    history: Path | None = None,
    options: Options = NO_OPTIONS,
) -> int:
    """Find the parameter values that optimise a response of a model file.

    Parameters
    ----------
    model
        Model file with [analysis], [responses] and [optimize].
    minimize
        Name of the response to minimise, instead of the file's.
    maximize
        Name of the response to maximise.
    vary
        Name of a parameter to vary, instead of the file's choice; repeatable.
    method
        Name of the optimiser, such as slsqp, ipopt or multistart.
    max_iterations
        Upper limit of iterations.
    beta
        Required reliability index of all limits, for the file's [[random]] parameters.
    output
        Folder for the best run (.optimum.nc), the numbers (.optimum.json) and the page
        (.optimum.report.html); none are written by default.
    history
        File that records all evaluated designs; the same command resumes after an interrupt.
    """
    from dalembert.io.model_file import with_keys

    objective = {"minimize": minimize, "maximize": maximize}
    if minimize or maximize:  # replaces the objective of the file, of either kind
        objective = {key: value or "" for key, value in objective.items()}
    changes = {"vary": vary, "method": method, "max_iterations": max_iterations, "beta": beta}
    changes |= objective

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.io.decisions.runs import optimization

        run = optimization(with_keys(file, "optimize", changes), built, history)
        return lambda show: run(iterations(show))

    return DecisionCommand(model, output, options).execute(read, _show)


def _show(summary: dict[str, Any]) -> None:
    change = f"{summary['start_fun']:.8g} → {summary['fun']:.8g} {summary['unit']}".rstrip()
    print_line(f"  objective {summary['objective']}  {change}")
    declared = {variable["name"]: variable for variable in summary["variables"]}
    for parameter, value in summary["x"].items():
        si = {"start": summary["start"][parameter], "value": value, "unit": ""}
        variable = declared.get(parameter, si)  # in the declared unit
        unit = "" if variable["unit"] in ("", "1") else f" {variable['unit']}"
        note = "  (at its bound)" if parameter in summary["at_bounds"] else ""
        print_line(
            f"  {parameter:<10} {variable['start']:.8g} → {variable['value']:.8g}{unit}{note}"
        )
    if summary["active"]:
        print_line(f"  limits that hold with equality: {', '.join(summary['active'])}")
    for sensitivity_text in summary["prices"]:
        print_line(f"  {sensitivity_text}")
    if summary["violation"] > 0:
        print_line(f"  largest relative violation of a limit: {summary['violation']:.3g}")
    for limit in summary.get("reliability", []):
        beta = "not found" if limit["beta"] is None else f"{limit['beta']:.6g}"
        at = ", ".join(f"{name} = {value:.6g}" for name, value in limit["point"].items())
        print_line(f"  {limit['label']}: β {beta}, worst at {at}")
    failed = f", {summary['failed_runs']} failed" if summary["failed_runs"] else ""
    iterations, runs = counted(summary["iterations"], "iteration"), counted(summary["runs"], "run")
    print_line(f"  {iterations}, {runs}{failed}")
