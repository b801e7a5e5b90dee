"""``--option NAME=VALUE`` of ``dalembert export``: options of a format."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from typing import Annotated, Any

from cyclopts import Parameter

from dalembert.errors import UnsupportedError

FormatOptions = Annotated[
    list[str],
    Parameter(
        name="--option",
        negative=(),
        help="Option of a format: frames=400, unit=mm, time=0.25; repeatable.",
    ),
]


def format_options(assignments: Sequence[str]) -> dict[str, Any]:
    """Name → value of ``NAME=VALUE``; a value is a TOML value, or a text without quotes.

    Raises
    ------
    UnsupportedError
        An assignment has no name or no value, or a name occurs twice.
    """
    options: dict[str, Any] = {}
    for assignment in assignments:
        name, _, text = assignment.partition("=")
        name, text = name.strip(), text.strip()
        if not name or not text:
            raise UnsupportedError(f"--option {assignment!r}: write NAME=VALUE, e.g. frames=400")
        if name in options:
            raise UnsupportedError(f"--option {name} is given twice; give it once")
        options[name] = _value(text)
    return options


def _value(text: str) -> Any:
    try:
        parsed = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError:
        return text
    return parsed["value"] if len(parsed) == 1 else text
