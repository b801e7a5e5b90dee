"""``dalembert tolerance``: tolerance analysis of a response."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import print_line
from dalembert.cli.decision import NO_OPTIONS, DecisionCommand, Options, Run

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


def tolerance(
    model: Path,
    /,
    *,
    samples: int | None = None,
    output: Path | None = None,
    options: Options = NO_OPTIONS,
) -> int:
    """Find the scatter of a response of a model file within the tolerances of its dimensions.

    Parameters
    ----------
    model
        Model file with [analysis], [responses] and [tolerance].
    samples
        Number of Monte Carlo samples in addition to the first and second order.
    output
        Folder for the numbers (.tolerance.nc, .tolerance.json) and the page
        (.tolerance.report.html); none are written by default.
    """
    from dalembert.io.model_file import with_keys

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.io.decisions.runs import scatter

        return scatter(with_keys(file, "tolerance", {"samples": samples}), built)

    return DecisionCommand(model, output, options).execute(read, _show)


def _show(summary: dict[str, Any]) -> None:
    unit = summary["unit"]
    spread = summary["sigmas"] * summary["std"]
    print_line(f"  ± {summary['sigmas']:g} σ, first order   {spread:.6g} {unit}".rstrip())
    if summary["second_order"]:
        second = summary["second_order"]
        spread = summary["sigmas"] * second["std"]
        print_line(f"  mean {second['mean']:.8g}, second order ± {spread:.6g} {unit}".rstrip())
    if summary["worst_case"]:
        low, high = summary["worst_case"]
        print_line(f"  worst case {low:.8g} … {high:.8g} {unit}".rstrip())
    for name, width in summary["tolerances"].items():
        share, effect = 100 * summary["contributions"][name], summary["effects"][name]
        enough = f"   enough: ± {summary['allocated'][name]:.4g}" if summary["allocated"] else ""
        print_line(f"  {name:<10} ± {width:.4g}   {effect:+.4g} {unit}   {share:5.1f} %{enough}")
    if summary["sampled"]:
        sampled = summary["sampled"]
        print_line(
            f"  {summary['samples']} samples: {sampled['mean']:.8g}, σ = {sampled['std']:.4g}"
        )
