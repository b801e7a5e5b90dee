"""Exit codes, terminal output and JSON output of all commands."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.errors import DalembertError
from dalembert.text.wording import as_document, visible

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

BETWEEN_COLUMNS = 2
"""Width of the space between two columns of a table."""
DONE, FAILED, WRONG_INPUT, INTERRUPTED = 0, 1, 2, 130

AsJson = Annotated[
    bool,
    Parameter(name="--json", negative=(), help="Print one JSON document instead of text."),
]
Settings = Annotated[
    list[str],
    Parameter(name="--set", negative=(), help="New value of a parameter: l1=0.25; repeatable."),
]
Quiet = Annotated[bool, Parameter(name=["--quiet", "-q"], negative=(), help="Print errors only.")]
Open = Annotated[bool, Parameter(name="--open", negative=(), help="Open the page in the browser.")]


class WrongInput(Exception):
    """Error in the input, raised before anything is computed."""

    def __init__(self, cause: DalembertError):
        self.cause = cause
        super().__init__(str(cause))


@contextmanager
def wrong_input() -> Iterator[None]:
    """Convert errors in the block into ``WrongInput``."""
    try:
        yield
    except DalembertError as error:
        raise WrongInput(error) from None


def console() -> Console:
    """Rich console; without colours if standard output is not a terminal."""
    from rich.console import Console

    return Console(highlight=False, soft_wrap=True)


def print_line(text: str, style: str | None = None) -> None:
    """Print a line on standard output, with control characters made visible."""
    from rich.text import Text

    console().print(Text(visible(text), style or ""))


def print_heading(name: str, text: str) -> None:
    """Print the heading of a report: a name and its description."""
    from rich.text import Text

    console().print(Text.assemble((visible(name), "bold"), ": ", visible(text)))


def print_files(files: Iterable[Path]) -> None:
    """Print the paths of the written files."""
    for path in files:
        print_line(f"  written {path}")


def open_pages(files: Iterable[Path], enabled: bool) -> None:
    """Open the HTML pages among the files in the browser, if enabled."""
    import webbrowser

    for path in files:
        if enabled and path.suffix == ".html":
            webbrowser.open(path.resolve().as_uri())


def print_json(data: Any) -> None:
    """Print a JSON document on standard output; numbers that are not finite become null."""
    print(as_document(data))


def format_value(value: Any) -> str:
    """A number with six digits, or the text of another value."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def fail(error: Exception, code: int, as_json: bool) -> int:
    """Print an error on standard error, or as JSON on standard output; returns the exit code."""
    if as_json:
        print_json(
            {
                "ok": False,
                "exit_code": code,
                "error": {"kind": type(error).__name__, "message": str(error)},
            }
        )
    else:
        print(f"Error: {visible(str(error))}", file=sys.stderr)
    return code


def aligned_table(title: str = "", columns_touch: bool = True) -> Table:
    """Empty table with a rule below its headings; ``columns_touch``: no padding between columns."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    return Table(
        title=Text(title) if title else None,
        title_justify="left",
        box=box.SIMPLE_HEAD,
        show_edge=False,
        pad_edge=False,
        collapse_padding=columns_touch,
    )


def print_table(
    headings: Sequence[str],
    rows: Sequence[Sequence[str]],
    title: str = "",
    columns_touch: bool = True,
) -> None:
    """Print a table, its first column to the left.

    Columns beyond the width of a terminal follow in further tables, which repeat the first one;
    files and pipes get one table.
    """
    from rich.text import Text

    columns = [[_visible_lines(cell) for cell in c] for c in zip(headings, *rows, strict=True)]
    widths = [max(len(line) for cell in column for line in cell.split("\n")) for column in columns]
    terminal = console()
    limited = terminal.is_terminal or "COLUMNS" in os.environ
    for k, block in enumerate(_blocks(widths, terminal.width if limited else None)):
        table = aligned_table("" if k else title, columns_touch)
        for j in block:
            table.add_column(Text(columns[j][0]), justify="right" if j else "left", no_wrap=True)
        for row in zip(*(columns[j][1:] for j in block), strict=True):
            table.add_row(*map(Text, row))
        terminal.width = max(
            terminal.width, sum(widths[j] for j in block) + BETWEEN_COLUMNS * len(block)
        )
        if k:
            print_line("")
        terminal.print(table)


def _visible_lines(text: str) -> str:
    return "\n".join(map(visible, text.split("\n")))


def _blocks(widths: Sequence[int], limit: int | None) -> list[list[int]]:
    """Numbers of the columns of each table, the first column in all of them."""
    blocks = [[0]]
    for k in range(1, len(widths)):
        block = [*blocks[-1], k]
        width = sum(widths[j] + BETWEEN_COLUMNS for j in block) - BETWEEN_COLUMNS
        if limit is not None and width > limit and len(block) > 2:
            blocks.append([0, k])
        else:
            blocks[-1] = block
    return blocks
