"""``dalembert identify``: parameter identification from measured time series."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import print_line
from dalembert.cli.decision import NO_OPTIONS, DecisionCommand, Options, Run, iterations

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


def identify(
    model: Path,
    /,
    *,
    data: Annotated[list[Path] | None, Parameter(negative=())] = None,
    output: Path | None = None,
    options: Options = NO_OPTIONS,
) -> int:
    """Find the parameter values with which a model file explains measured time series.

    Parameters
    ----------
    model
        Model file with [analysis] and [identify].
    data
        File of measurements, .csv or .parquet, instead of the file's; repeatable, one per run.
    output
        Folder for the picture of data, model and residuals (.identified.png), the covariance
        (.covariance.csv), the numbers (.identification.nc, .identification.json) and the page
        (.identification.report.html); none are written by default.
    """

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.io.decisions.runs import identification

        run = identification(file, built, data)
        return lambda show: run(iterations(show))

    return DecisionCommand(model, output, options).execute(read, _show)


def _show(summary: dict[str, Any]) -> None:
    for parameter, value in summary["x"].items():
        low, high = summary["interval"][parameter]
        start = summary["start"][parameter]
        print_line(f"  {parameter:<10} {start:.8g} → {value:.8g}   95 %: {low:.6g} … {high:.6g}")
    kind = "specified" if summary["noise_specified"] else "estimated"
    for column, level in summary["noise"].items():
        print_line(f"  noise of {column}: {level:.3g} ({kind})")
    for note in summary["notes"]:
        print_line(f"  note: {note}", "yellow")
    print_line(f"  {summary['samples']} samples, {summary['runs']} runs")
