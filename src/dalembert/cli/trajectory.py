"""``dalembert trajectory``: the best motion of a model file, and the controls that make it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import tell
from dalembert.cli.decision import PLAIN, Asked, Options, Run, iterations

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


def trajectory(
    model: Path,
    /,
    *,
    minimize: str | None = None,
    output: Path | None = None,
    options: Options = PLAIN,
) -> int:
    """Find the best motion of a model file, the controls that make it, and dimensions with them.

    Parameters
    ----------
    model
        Model file with [trajectory].
    minimize
        Name of the response to make small, or time, instead of the file's.
    output
        Folder for the motion (.trajectory.nc), the controls (.trajectory.json) and the page
        (.trajectory.report.html); none are written by default.
    """
    from dalembert.io.model_file import with_keys

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.design.trajectory.optimize_trajectory import optimize_trajectory
        from dalembert.io.decisions.trajectories import make_trajectory

        asked = make_trajectory(with_keys(file, "trajectory", {"minimize": minimize}), built)
        return lambda show: optimize_trajectory(built, **asked, progress=iterations(show))

    return Asked(model, output, options).decide(read, _show)


def _show(made: dict[str, Any]) -> None:
    unit = f" {made['unit']}" if made["unit"] else ""
    tell(f"  {made['objective']} {made['fun']:.8g}{unit} in {made['duration']:.6g} s")
    for name, control in made["controls"].items():
        low, high = min(control["values"]), max(control["values"])
        tell(f"  {name:<10} {low:.6g} … {high:.6g} {control['unit']}".rstrip())
    for name, value in made["x"].items():
        tell(f"  {name:<10} {made['start'][name]:.8g} → {value:.8g}")
    tell(f"  defect {made['defect']:.2g}, {made['deviation']:.2g} from its forward run")
    tell(f"  {made['iterations']} iterations, {made['intervals']} intervals")
