"""``dalembert pareto``: designs of which none is better in all aims."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import tell
from dalembert.cli.decision import PLAIN, Asked, Options, Run

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


def pareto(
    model: Path,
    /,
    *,
    points: int | None = None,
    method: str | None = None,
    output: Path | None = None,
    options: Options = PLAIN,
) -> int:
    """Find the designs of a model file of which none is better in all aims.

    Parameters
    ----------
    model
        Model file with [analysis], [responses] and [pareto].
    points
        Along each side of the front, instead of the file's.
    method
        How it is searched for: normal-constraint, epsilon-constraint, nsga2 or nsga3.
    output
        Folder for the designs (.pareto.nc, .pareto.json) and the page on which to choose one
        (.pareto.report.html); none are written by default.
    """
    from dalembert.io.model_file import with_keys

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.design.pareto.pareto import pareto as front_of
        from dalembert.io.analyses import make_analysis
        from dalembert.io.decisions.designs import make_front

        front = make_front(with_keys(file, "pareto", {"points": points, "method": method}), built)
        task = make_analysis(file, built)
        return lambda show: front_of(built, **front, analysis=task, progress=show)

    return Asked(model, output, options).decide(read, _show)


def _show(made: dict[str, Any]) -> None:
    aims = [f"{a} [{u}]" if u else a for a, u in zip(made["aims"], made["units"], strict=True)]
    if made["points"]:
        heads = [*aims, *made["points"][0]["parameters"]]
        wide = [max(12, len(head) + 2) for head in heads]
        tell("  " + "".join(head.rjust(w) for head, w in zip(heads, wide, strict=True)))
    for point in made["points"]:
        row = [*point["aims"].values(), *point["parameters"].values()]
        tell("  " + "".join(f"{v:.6g}".rjust(w) for v, w in zip(row, wide, strict=True)))
    for text in made["failed"]:
        tell(f"  no point: {text}", "yellow")
    tell(f"  {len(made['points'])} designs, {made['runs']} runs, {made['gradients']} gradients")
