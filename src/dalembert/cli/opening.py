"""Pages that were written are opened, where that is asked for."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

Open = Annotated[bool, Parameter(name="--open", negative=(), help="Open the page in the browser.")]


def opened(files: Iterable[Path], asked: bool) -> None:
    """Open the pages among some files in the browser, if asked."""
    import webbrowser

    for path in files:
        if asked and path.suffix == ".html":
            webbrowser.open(path.resolve().as_uri())
