"""``dalembert identify``: the parameters of a model file that explain measurements."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import tell
from dalembert.cli.decision import PLAIN, Asked, Options, Run, iterations

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


def identify(
    model: Path,
    /,
    *,
    data: Annotated[list[Path] | None, Parameter(negative=())] = None,
    output: Path | None = None,
    options: Options = PLAIN,
) -> int:
    """Find the parameter values with which a model file explains measured time series.

    Parameters
    ----------
    model
        Model file with [analysis] and [identify].
    data
        File of measurements, .csv or .parquet, instead of the file's; repeatable, one for each run.
    output
        Folder for the picture of data, model and residuals (.identified.png), the covariance
        (.covariance.csv), the numbers (.identification.nc, .identification.json) and the page
        (.identification.report.html); none are written by default.
    """

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.design.identification.identify import identify as found_from
        from dalembert.io.analyses import make_analysis
        from dalembert.io.decisions.estimation import check_files, make_identification

        asked = make_identification(file, built, data)
        task = make_analysis(file, built) if file.document.analysis is not None else None
        check_files([experiment.data for experiment in asked["data"]])
        return lambda show: found_from(built, **asked, analysis=task, progress=iterations(show))

    return Asked(model, output, options).decide(read, _show)


def _show(made: dict[str, Any]) -> None:
    for parameter, value in made["x"].items():
        low, high = made["interval"][parameter]
        start = made["start"][parameter]
        tell(f"  {parameter:<10} {start:.8g} → {value:.8g}   95 %: {low:.6g} … {high:.6g}")
    kind = "given" if made["noise_given"] else "estimated"
    for column, level in made["noise"].items():
        tell(f"  noise of {column}: {level:.3g} ({kind})")
    for note in made["notes"]:
        tell(f"  note: {note}", "yellow")
    tell(f"  {made['samples']} samples, {made['runs']} runs")
