"""``dalembert pareto``: Pareto-optimal designs of a model file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import print_line
from dalembert.cli.decision import NO_OPTIONS, DecisionCommand, Options, Run

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


def pareto(
    model: Path,
    /,
    *,
    points: int | None = None,
    method: str | None = None,
    output: Path | None = None,
    options: Options = NO_OPTIONS,
) -> int:
    """Find the Pareto-optimal designs of a model file.

    Parameters
    ----------
    model
        Model file with [analysis], [responses] and [pareto].
    points
        Number of points along each edge of the front, instead of the file's.
    method
        Name of the method: normal-constraint, epsilon-constraint, nsga2 or nsga3.
    output
        Folder for the designs (.pareto.nc, .pareto.json) and the page for choosing one
        (.pareto.report.html); none are written by default.
    """
    from dalembert.io.model_file import with_keys

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.io.decisions.runs import front

        return front(with_keys(file, "pareto", {"points": points, "method": method}), built)

    return DecisionCommand(model, output, options).execute(read, _show)


def _show(summary: dict[str, Any]) -> None:
    aims = [
        f"{a} [{u}]" if u else a for a, u in zip(summary["aims"], summary["units"], strict=True)
    ]
    if summary["points"]:
        headings = [*aims, *summary["points"][0]["parameters"]]
        widths = [max(12, len(heading) + 2) for heading in headings]
        print_line(
            "  "
            + "".join(heading.rjust(width) for heading, width in zip(headings, widths, strict=True))
        )
    for point in summary["points"]:
        row = [*point["aims"].values(), *point["parameters"].values()]
        print_line(
            "  " + "".join(f"{v:.6g}".rjust(width) for v, width in zip(row, widths, strict=True))
        )
    for text in summary["failed"]:
        print_line(f"  no point: {text}", "yellow")
    print_line(
        f"  {len(summary['points'])} designs, {summary['runs']} runs, "
        f"{summary['gradients']} gradients"
    )
