"""``dalembert identify``: the parameters of a model file that explain measurements."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import (
    DONE,
    FAILED,
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
    from dalembert.design.identification.identified import Identification


def identify(
    model: Path,
    /,
    *,
    data: Annotated[list[Path] | None, Parameter(negative=())] = None,
    output: Path | None = None,
    settings: Settings | None = None,
    quiet: Annotated[Quiet, Parameter(help="Do not print the iterations.")] = False,
    as_json: AsJson = False,
) -> int:
    """Find the parameter values with which a model file explains measured time series.

    Parameters
    ----------
    model
        Model file with [analysis] and [identify].
    data
        File of measurements, .csv or .parquet, instead of the file's; repeatable, one for each run.
    output
        Folder for the picture of data, model and residuals (.identified.png) and the covariance
        (.covariance.csv); none are written by default.
    """
    from dalembert.design.identification.identify import identify as found_from
    from dalembert.io.analyses import make_analysis
    from dalembert.io.identification import check_data, make_identification

    file, built = loaded(model, settings)
    with wrong_input():
        asked = make_identification(file, built, data)
        task = make_analysis(file, built) if file.document.analysis is not None else None
        check_data(asked["data"])
    folder = output_folder(output) if output else None

    def told(number: int, cost: float) -> None:
        print(f"iteration {number}: {cost:.8g}", file=sys.stderr)

    silent = quiet or as_json
    found = found_from(built, **asked, analysis=task, progress=False if silent else told)
    files = _write(found, folder / file.path.stem) if folder else []
    made = _document(found, files)
    if as_json:
        emit(made)
    else:
        _print(file.name, made)
    return DONE if found.success else FAILED


def _write(found: Identification, base: Path) -> list[Path]:
    import matplotlib as mpl

    from dalembert.atomic import atomic_path

    mpl.use("Agg")
    files = [base.with_name(f"{base.name}.{end}") for end in ("identified.png", "covariance.csv")]
    with atomic_path(files[0]) as temporary:
        found.plot().savefig(temporary, format="png", dpi=110)
    with atomic_path(files[1]) as temporary:
        found.covariance.to_pandas().to_csv(temporary)
    return files


def _document(found: Identification, files: list[Path]) -> dict[str, Any]:
    return {
        "ok": found.success,
        "message": found.message,
        "x": found.x,
        "deviation": found.deviation,
        "interval": found.interval(),
        "start": dict(zip(found.x, found.misfit.unknowns.start.tolist(), strict=True)),
        "noise": found.noise,
        "noise_given": found.noise_given,
        "samples": found.samples,
        "correlation": found.correlation.values.tolist(),
        "notes": found.notes,
        "runs": found.runs,
        "failed_runs": found.failed_runs,
        "files": [str(f) for f in files],
    }


def _print(name: str, made: dict[str, Any]) -> None:
    tell(f"{name}: {made['message']}", "green" if made["ok"] else "red")
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
    written(map(Path, made["files"]))
