"""``dalembert studio``: a page on this machine in which a model is drawn and written."""

from __future__ import annotations

import sys
import webbrowser
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from dalembert.cli.console import DONE, AsJson, print_json, print_line, wrong_input


def studio(
    model: Path | None = None,
    /,
    *,
    port: int = 0,
    open_page: Annotated[bool, Parameter(name="--open")] = True,
    as_json: AsJson = False,
) -> int:
    """Draw and write a model in the browser, with a live picture of it.

    The page is served on this machine only, until Ctrl-C or its button Stop. Unsaved changes are
    kept for the next time.

    Parameters
    ----------
    model
        Model file (TOML); a new one by default.
    port
        Port of the loopback interface; a free one by default.
    open_page
        Open the page in the browser.
    """
    from dalembert.packages import optional_package

    def ready(address: str) -> None:
        if as_json:
            print_json({"ok": True, "address": address})
        else:
            print_line(f"studio: {address}\nCtrl-C stops it")
        sys.stdout.flush()

    def begin(address: str) -> None:
        if open_page:
            webbrowser.open(address)

    with wrong_input():
        for package in ("starlette", "uvicorn", "websockets"):
            optional_package(package, "the studio")
        from dalembert.studio.server import serve

        serve(model, port, ready, begin)
    return DONE
