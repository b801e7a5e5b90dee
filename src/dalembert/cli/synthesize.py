"""``dalembert synthesize``: mechanisms that do what a file asks for."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import tell
from dalembert.cli.decision import PLAIN, Asked, Options, Run

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile

SHOWN = 5


def synthesize(
    file: Path,
    /,
    *,
    starts: int | None = None,
    output: Path | None = None,
    options: Options = PLAIN,
) -> int:
    """Find linkages, or dimensions of the file's mechanism, for a path, a motion or a function.

    Parameters
    ----------
    file
        File with [synthesis]; it needs no bodies where a linkage is named.
    starts
        How many are polished, instead of the file's.
    output
        Folder for the candidates (.synthesis.nc, .synthesis.json) and the page on which to choose
        one (.synthesis.report.html); none are written by default.
    """
    from dalembert.io.model_file import with_keys

    def read(given: ModelFile, _: Any) -> Run:
        from dalembert.io.decisions.synthesis import make_synthesis

        search = make_synthesis(with_keys(given, "synthesis", {"starts": starts}))

        def run(show: bool) -> Any:
            with given.located("synthesis"):
                found = search(progress=show)
            found.name = given.name
            return found

        return run

    return Asked(file, output, options).decide(read, _show, assembled=False)


def _show(made: dict[str, Any]) -> None:
    for k, one in enumerate(made["solutions"][:SHOWN], start=1):
        sizes = ", ".join(f"{n} = {v:.5g}" for n, v in one["dimensions"].items() if v)
        turns = "turns" if one["crank_turns"] else "rocks"
        tell(f"  {k}. error {one['error']:.4g}, crank {turns}: {sizes}")
    left = len(made["solutions"]) - SHOWN
    if left > 0:
        tell(f"  and {left} more")
    tell(f"  {made['starts']} starts")
