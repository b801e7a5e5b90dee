"""``dalembert optimize``: the best parameters for a response of a model file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import tell
from dalembert.cli.decision import PLAIN, Asked, Options, Run, iterations

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
    options: Options = PLAIN,
) -> int:
    """Find the parameter values that make a response of a model file best.

    Parameters
    ----------
    model
        Model file with [analysis], [responses] and [optimize].
    minimize
        Name of the response to make small, instead of the file's.
    maximize
        Name of the response to make large.
    vary
        Name of a parameter to vary, instead of the file's choice; repeatable.
    method
        How it is searched for, such as slsqp, ipopt or multistart.
    max_iterations
        Most iterations.
    beta
        Reliability index with which all limits hold, over the file's [[random]].
    output
        Folder for the best run (.optimum.nc), the numbers (.optimum.json) and the page
        (.optimum.report.html); none are written by default.
    history
        File in which all designs run are kept; the same call goes on from it after an interrupt.
    """
    from dalembert.io.model_file import with_keys

    objective = {"minimize": minimize, "maximize": maximize}
    if minimize or maximize:  # the file's own is replaced, whichever it is
        objective = {key: value or "" for key, value in objective.items()}
    changes = {"vary": vary, "method": method, "max_iterations": max_iterations, "beta": beta}
    changes |= objective

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.io.analyses import make_analysis
        from dalembert.io.decisions.designs import make_design

        design = make_design(with_keys(file, "optimize", changes), built)
        design["analysis"] = make_analysis(file, built)
        best_of = _search("beta" in design)
        return lambda show: best_of(built, **design, history=history, progress=iterations(show))

    return Asked(model, output, options).decide(read, _show)


def _search(reliable: bool) -> Callable[..., Any]:
    """What optimises: at the design alone, or with a reliability."""
    from dalembert.design.optimize.optimization import optimize as best_of
    from dalembert.design.reliability.optimize_reliable import optimize_reliable

    return optimize_reliable if reliable else best_of


def _show(made: dict[str, Any]) -> None:
    change = f"{made['start_fun']:.8g} → {made['fun']:.8g} {made['unit']}".rstrip()
    tell(f"  objective {made['objective']}  {change}")
    declared = {one["name"]: one for one in made["variables"]}
    for parameter, value in made["x"].items():
        si = {"start": made["start"][parameter], "value": value, "unit": ""}
        one = declared.get(parameter, si)  # in the unit of its declaration
        unit = "" if one["unit"] in ("", "1") else f" {one['unit']}"
        note = "  (at its bound)" if parameter in made["at_bounds"] else ""
        tell(f"  {parameter:<10} {one['start']:.8g} → {one['value']:.8g}{unit}{note}")
    if made["active"]:
        tell(f"  limits that hold with equality: {', '.join(made['active'])}")
    for price in made["prices"]:
        tell(f"  {price}")
    if made["violation"] > 0:
        tell(f"  largest relative violation of a limit: {made['violation']:.3g}")
    for limit in made.get("reliability", []):
        beta = "not found" if limit["beta"] is None else f"{limit['beta']:.6g}"
        at = ", ".join(f"{name} = {value:.6g}" for name, value in limit["point"].items())
        tell(f"  {limit['label']}: β {beta}, worst at {at}")
    failed = f", {made['failed_runs']} failed" if made["failed_runs"] else ""
    tell(f"  {made['iterations']} iterations, {made['runs']} runs{failed}")
