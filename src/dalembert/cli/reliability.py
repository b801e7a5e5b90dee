"""``dalembert reliability``: how probable it is that random parameters break a limit."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import tell
from dalembert.cli.decision import PLAIN, Asked, Options, Run

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


def reliability(
    model: Path,
    /,
    *,
    samples: int | None = None,
    sampling: str | None = None,
    starts: int | None = None,
    output: Path | None = None,
    options: Options = PLAIN,
) -> int:
    """Find how probable it is that the random parameters of a model file break a limit.

    Parameters
    ----------
    model
        Model file with [analysis], [responses], [reliability] and [[random]].
    samples
        Of an estimate beside that of the design point.
    sampling
        How they are drawn: importance-sampling, monte-carlo or subset-simulation.
    starts
        Of the search, to find further design points.
    output
        Folder for the numbers (.reliability.nc, .reliability.json) and the page
        (.reliability.report.html); none are written by default.
    """
    from dalembert.io.model_file import with_keys

    changes = {"samples": samples, "sampling": sampling, "starts": starts}

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.design.reliability.reliability import reliability as reliability_of
        from dalembert.io.analyses import make_analysis
        from dalembert.io.decisions.reliability import make_reliability

        asked = make_reliability(with_keys(file, "reliability", changes), built)
        task = make_analysis(file, built)
        return lambda show: reliability_of(built, **asked, analysis=task, progress=show)

    return Asked(model, output, options).decide(read, _show)


def _show(made: dict[str, Any]) -> None:
    tell(f"  reliability index β = {made['beta']:.6g}, probability {made['probability']:.4g}")
    for point in made["points"]:
        at = ", ".join(f"{name} = {value:.6g}" for name, value in point["x"].items())
        tell(f"  {point['limit']}: β = {point['beta']:.6g} at {at}")
    for name, share in made["importance"].items():
        tell(f"  {name:<10} {100 * share:5.1f} % of the variance")
    if made["sampled"]:
        low, high = made["sampled"]["interval"]
        probability = made["sampled"]["probability"]
        tell(f"  by samples {probability:.4g}, 95 %: {low:.3g} … {high:.3g}")
    tell(f"  {made['calls']} evaluations")
