"""``dalembert invert``: forces and drives that explain measured motion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import tell
from dalembert.cli.decision import PLAIN, Asked, Options, Run, iterations

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


def invert(
    model: Path,
    /,
    *,
    data: Path | None = None,
    smoothing: str | None = None,
    output: Path | None = None,
    options: Options = PLAIN,
) -> int:
    """Find the forces and drives with which a model file explains measured motion.

    Parameters
    ----------
    model
        Model file with [analysis], [histories] and [invert].
    data
        File of measurements, .csv, .parquet or .c3d, instead of the file's.
    smoothing
        likelihood, cross-validation, l-curve, discrepancy, or a number, instead of the file's.
    output
        Folder for the histories (.inversion.nc, .inversion.json) and the page
        (.inversion.report.html); none are written by default.
    """
    from dalembert.io.model_file import with_keys

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.design.inverse.invert import invert as histories_of
        from dalembert.io.analyses import make_analysis
        from dalembert.io.decisions.estimation import check_files, make_inversion

        changes = {"smoothing": smoothing}
        asked = make_inversion(with_keys(file, "invert", changes), built, [data] if data else None)
        task = make_analysis(file, built)
        check_files([asked["data"]])
        return lambda show: histories_of(built, **asked, analysis=task, progress=iterations(show))

    return Asked(model, output, options).decide(read, _show)


def _show(made: dict[str, Any]) -> None:
    for name, one in made["histories"].items():
        values, unit = one["values"], one["unit"]
        tell(f"  {name}: {min(values):.6g} … {max(values):.6g} {unit} at {len(values)} knots")
    tell(f"  smoothing {made['smoothing']:.4g}, misfit {made['misfit']:.6g}")
    tell(f"  {made['samples']} samples, {made['runs']} runs")
