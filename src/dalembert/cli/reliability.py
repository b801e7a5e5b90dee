"""``dalembert reliability``: probability that random parameters violate a limit."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import print_line
from dalembert.cli.decision import NO_OPTIONS, DecisionCommand, Options, Run

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
    options: Options = NO_OPTIONS,
) -> int:
    """Find the probability that the random parameters of a model file violate a limit.

    Parameters
    ----------
    model
        Model file with [analysis], [responses], [reliability] and [[random]].
    samples
        Number of samples for an estimate in addition to that of the design point.
    sampling
        Sampling method: importance-sampling, monte-carlo or subset-simulation.
    starts
        Number of starts of the search for design points.
    output
        Folder for the numbers (.reliability.nc, .reliability.json) and the page
        (.reliability.report.html); none are written by default.
    """
    from dalembert.io.model_file import with_keys

    changes = {"samples": samples, "sampling": sampling, "starts": starts}

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.io.decisions.runs import failure_probability

        return failure_probability(with_keys(file, "reliability", changes), built)

    return DecisionCommand(model, output, options).execute(read, _show)


def _show(summary: dict[str, Any]) -> None:
    print_line(
        f"  reliability index β = {summary['beta']:.6g}, probability {summary['probability']:.4g}"
    )
    for point in summary["points"]:
        at = ", ".join(f"{name} = {value:.6g}" for name, value in point["x"].items())
        print_line(f"  {point['limit']}: β = {point['beta']:.6g} at {at}")
    for name, share in summary["importance"].items():
        print_line(f"  {name:<10} {100 * share:5.1f} % of the variance")
    if summary["sampled"]:
        low, high = summary["sampled"]["interval"]
        probability = summary["sampled"]["probability"]
        print_line(f"  by samples {probability:.4g}, 95 %: {low:.3g} … {high:.3g}")
    print_line(f"  {summary['calls']} evaluations")
