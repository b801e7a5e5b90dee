"""``dalembert report``: the interactive page of a result file, drawn again."""

from __future__ import annotations

from pathlib import Path

from dalembert.cli.console import DONE, AsJson, emit, tell, wrong_input
from dalembert.cli.loading import refuse_replacing, shown_warnings
from dalembert.cli.opening import Open, opened


def report(
    results: Path,
    other: Path | None = None,
    /,
    *,
    output: Path | None = None,
    open_page: Open = False,
    as_json: AsJson = False,
) -> int:
    """Write the interactive report of a result file (.nc), with a second run on it if given.

    Parameters
    ----------
    results
        Result file written by 'dalembert run'.
    other
        Another run of the mechanism, drawn dashed beside the first.
    output
        Name of the page; by default beside the results.
    """
    from dalembert.report.overlay import overlay
    from dalembert.report.page import write_page
    from dalembert.results.files.store import load_results, report_of

    with wrong_input(), shown_warnings():
        payload = report_of(load_results(results))
        if other is not None:
            payload = overlay(payload, report_of(load_results(other)), str(other))
        page = output or results.with_suffix(".report.html")
        for read in (results, *([] if other is None else [other])):
            refuse_replacing(read, [page])
        write_page(payload, page)
    if as_json:
        emit({"ok": True, "files": [str(page)]})
    else:
        tell(f"written {page}")
    opened([page], open_page)
    return DONE
