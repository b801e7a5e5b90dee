"""``dalembert tolerance``: how a response scatters within the tolerances of a drawing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import tell
from dalembert.cli.decision import PLAIN, Asked, Options, Run

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


def tolerance(
    model: Path,
    /,
    *,
    samples: int | None = None,
    output: Path | None = None,
    options: Options = PLAIN,
) -> int:
    """Find how a response of a model file scatters within the tolerances of its dimensions.

    Parameters
    ----------
    model
        Model file with [analysis], [responses] and [tolerance].
    samples
        Of Monte Carlo beside the first and second order.
    output
        Folder for the numbers (.tolerance.nc, .tolerance.json) and the page
        (.tolerance.report.html); none are written by default.
    """
    from dalembert.io.model_file import with_keys

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.design.tolerance.tolerance import tolerance as tolerance_of
        from dalembert.io.analyses import make_analysis
        from dalembert.io.decisions.reliability import make_tolerance

        asked, allot = make_tolerance(with_keys(file, "tolerance", {"samples": samples}), built)
        task = make_analysis(file, built)

        def run(show: bool) -> Any:
            found = tolerance_of(built, **asked, analysis=task, progress=show)
            if allot is not None:
                with file.located("tolerance", "allot"):
                    found.allotted = found.allot(**allot)
            return found

        return run

    return Asked(model, output, options).decide(read, _show)


def _show(made: dict[str, Any]) -> None:
    unit = made["unit"]
    spread = made["sigmas"] * made["std"]
    tell(f"  ± {made['sigmas']:g} σ, first order   {spread:.6g} {unit}".rstrip())
    if made["second_order"]:
        second = made["second_order"]
        spread = made["sigmas"] * second["std"]
        tell(f"  mean {second['mean']:.8g}, second order ± {spread:.6g} {unit}".rstrip())
    if made["worst_case"]:
        low, high = made["worst_case"]
        tell(f"  worst case {low:.8g} … {high:.8g} {unit}".rstrip())
    for name, width in made["tolerances"].items():
        share, effect = 100 * made["contributions"][name], made["effects"][name]
        enough = f"   enough: ± {made['allotted'][name]:.4g}" if made["allotted"] else ""
        tell(f"  {name:<10} ± {width:.4g}   {effect:+.4g} {unit}   {share:5.1f} %{enough}")
    if made["sampled"]:
        sampled = made["sampled"]
        tell(f"  {made['samples']} samples: {sampled['mean']:.8g}, σ = {sampled['std']:.4g}")
