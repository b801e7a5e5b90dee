"""``dalembert invert``: identification of forces and drives from measured motion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import print_line
from dalembert.cli.decision import NO_OPTIONS, DecisionCommand, Options, Run, iterations

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


def invert(
    model: Path,
    /,
    *,
    data: Path | None = None,
    smoothing: str | None = None,
    output: Path | None = None,
    options: Options = NO_OPTIONS,
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
        from dalembert.design.inverse.invert import invert as identify_histories
        from dalembert.io.analyses import make_analysis
        from dalembert.io.decisions.estimation import check_files, make_inversion

        changes = {"smoothing": smoothing}
        arguments = make_inversion(
            with_keys(file, "invert", changes), built, [data] if data else None
        )
        analysis = make_analysis(file, built)
        check_files([arguments["data"]])
        return lambda show: identify_histories(
            built, **arguments, analysis=analysis, progress=iterations(show)
        )

    return DecisionCommand(model, output, options).execute(read, _show)


def _show(summary: dict[str, Any]) -> None:
    for name, history in summary["histories"].items():
        values, unit = history["values"], history["unit"]
        print_line(f"  {name}: {min(values):.6g} … {max(values):.6g} {unit} at {len(values)} knots")
    print_line(f"  smoothing {summary['smoothing']:.4g}, misfit {summary['misfit']:.6g}")
    print_line(f"  {summary['samples']} samples, {summary['runs']} runs")
