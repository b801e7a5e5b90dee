"""``dalembert report``: the interactive page of a result file, drawn again."""

from __future__ import annotations

from pathlib import Path

from dalembert.cli.console import DONE, AsJson, emit, tell, wrong_input
from dalembert.cli.loading import refuse_replacing


def report(results: Path, /, *, output: Path | None = None, as_json: AsJson = False) -> int:
    """Write the interactive report of a result file (.nc).

    Parameters
    ----------
    results
        Result file written by 'dalembert run'.
    output
        Name of the page; by default beside the results.
    """
    from dalembert.report.page import write_page
    from dalembert.results.store import load_results, report_of

    with wrong_input():
        payload = report_of(load_results(results))
        page = output or results.with_suffix(".report.html")
        refuse_replacing(results, [page])
        write_page(payload, page)
    if as_json:
        emit({"ok": True, "files": [str(page)]})
    else:
        tell(f"written {page}")
    return DONE
