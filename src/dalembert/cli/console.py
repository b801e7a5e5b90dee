"""What all commands share: exit codes, plain or JSON output."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.errors import DalembertError
from dalembert.text.wording import as_document, visible

if TYPE_CHECKING:
    from rich.console import Console

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


class WrongInput(Exception):
    """An error met before anything was computed: the input is at fault, not the analysis."""

    def __init__(self, cause: DalembertError):
        self.cause = cause
        super().__init__(str(cause))


@contextmanager
def wrong_input() -> Iterator[None]:
    """Errors inside are due to what the user gave."""
    try:
        yield
    except DalembertError as error:
        raise WrongInput(error) from None


def console() -> Console:
    """Terminal output; without colours where it is not a terminal."""
    from rich.console import Console

    return Console(highlight=False, soft_wrap=True)


def tell(text: str, style: str | None = None) -> None:
    """A line on standard output, whatever is in it."""
    from rich.text import Text

    console().print(Text(visible(text), style or ""))


def head(name: str, text: str) -> None:
    """The first line of what is told: a name, and what it is."""
    from rich.text import Text

    console().print(Text.assemble((visible(name), "bold"), ": ", visible(text)))


def written(files: Iterable[Path]) -> None:
    """Which files there are now."""
    for path in files:
        tell(f"  written {path}")


def emit(data: Any) -> None:
    """One JSON document on standard output; null where a number is not finite."""
    print(as_document(data))


def shown(value: Any) -> str:
    """A number or text for people."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def fail(error: Exception, code: int, as_json: bool) -> int:
    """Tell an error on standard error, or as JSON on standard output; returns the exit code."""
    if as_json:
        emit(
            {
                "ok": False,
                "exit_code": code,
                "error": {"kind": type(error).__name__, "message": str(error)},
            }
        )
    else:
        print(f"Error: {visible(str(error))}", file=sys.stderr)
    return code
