"""``dalembert report``: the interactive page of a result file."""

from __future__ import annotations

from pathlib import Path

from dalembert.cli.console import (
    DONE,
    AsJson,
    Open,
    open_pages,
    print_json,
    print_line,
    wrong_input,
)
from dalembert.cli.loading import print_warnings, refuse_replacing


def report(
    results: Path,
    other: Path | None = None,
    /,
    *,
    output: Path | None = None,
    open_page: Open = False,
    as_json: AsJson = False,
) -> int:
    """Write the interactive report of a result file (.nc), optionally with a second run.

    Parameters
    ----------
    results
        Result file written by 'dalembert run'.
    other
        Another run of the mechanism, drawn dashed.
    output
        Name of the page; by default in the folder of the results.
    """
    from dalembert.report.overlay import overlay
    from dalembert.report.page import write_page
    from dalembert.results.files.store import load_results, report_of

    with wrong_input(), print_warnings():
        payload = report_of(load_results(results))
        if other is not None:
            payload = overlay(payload, report_of(load_results(other)), str(other))
        page = output or results.with_suffix(".report.html")
        for source in (results, *([] if other is None else [other])):
            refuse_replacing(source, [page])
        write_page(payload, page)
    if as_json:
        print_json({"ok": True, "files": [str(page)]})
    else:
        print_line(f"written {page}")
    open_pages([page], open_page)
    return DONE
