"""``dalembert trajectory``: trajectory optimisation of a model file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import print_line
from dalembert.cli.decision import NO_OPTIONS, DecisionCommand, Options, Run, iterations
from dalembert.text.wording import counted

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


def trajectory(
    model: Path,
    /,
    *,
    minimize: str | None = None,
    output: Path | None = None,
    options: Options = NO_OPTIONS,
) -> int:
    """Find the optimal motion of a model file, its controls, and optionally dimensions.

    Parameters
    ----------
    model
        Model file with [trajectory].
    minimize
        Name of the response to minimise, or time, instead of the file's.
    output
        Folder for the motion (.trajectory.nc), the controls (.trajectory.json) and the page
        (.trajectory.report.html); none are written by default.
    """
    from dalembert.io.model_file import with_keys

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.design.trajectory.optimize_trajectory import optimize_trajectory
        from dalembert.io.decisions.trajectories import make_trajectory

        arguments = make_trajectory(with_keys(file, "trajectory", {"minimize": minimize}), built)
        return lambda show: optimize_trajectory(built, **arguments, progress=iterations(show))

    return DecisionCommand(model, output, options).execute(read, _show)


def _show(summary: dict[str, Any]) -> None:
    unit = f" {summary['unit']}" if summary["unit"] else ""
    print_line(
        f"  {summary['objective']} {summary['fun']:.8g}{unit} in {summary['duration']:.6g} s"
    )
    for name, control in summary["controls"].items():
        low, high = min(control["values"]), max(control["values"])
        print_line(f"  {name:<10} {low:.6g} … {high:.6g} {control['unit']}".rstrip())
    for name, value in summary["x"].items():
        print_line(f"  {name:<10} {summary['start'][name]:.8g} → {value:.8g}")
    print_line(f"  defect {summary['defect']:.2g}, {summary['deviation']:.2g} from its forward run")
    iterations = counted(summary["iterations"], "iteration")
    print_line(f"  {iterations}, {counted(summary['intervals'], 'interval')}")
