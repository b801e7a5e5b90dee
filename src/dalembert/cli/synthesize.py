"""``dalembert synthesize``: dimensional synthesis of linkages and mechanisms."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import print_line
from dalembert.cli.decision import NO_OPTIONS, DecisionCommand, Options, Run

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile

MAX_SOLUTIONS = 5
"""Upper limit of solutions printed on the terminal."""


def synthesize(
    file: Path,
    /,
    *,
    starts: int | None = None,
    output: Path | None = None,
    options: Options = NO_OPTIONS,
) -> int:
    """Find linkages, or dimensions of the file's mechanism, for a path, a motion or a function.

    Parameters
    ----------
    file
        File with [synthesis]; bodies are optional if a linkage is named.
    starts
        Number of starts of the local search, instead of the file's.
    output
        Folder for the candidates (.synthesis.nc, .synthesis.json) and the page for choosing
        one (.synthesis.report.html); none are written by default.
    """
    from dalembert.io.model_file import with_keys

    def read(model_file: ModelFile, _: Any) -> Run:
        from dalembert.io.decisions.runs import synthesis

        return synthesis(with_keys(model_file, "synthesis", {"starts": starts}))

    return DecisionCommand(file, output, options).execute(read, _show, assembled=False)


def _show(summary: dict[str, Any]) -> None:
    for k, solution in enumerate(summary["solutions"][:MAX_SOLUTIONS], start=1):
        sizes = ", ".join(f"{n} = {v:.5g}" for n, v in solution["dimensions"].items() if v)
        turns = "turns" if solution["crank_turns"] else "rocks"
        print_line(f"  {k}. error {solution['error']:.4g}, crank {turns}: {sizes}")
    left = len(summary["solutions"]) - MAX_SOLUTIONS
    if left > 0:
        print_line(f"  and {left} more")
    print_line(f"  {summary['starts']} starts")
