"""Error messages of invalid files: file, location, value and fix."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from dalembert.errors import ModelError
from dalembert.io.values import short_repr
from dalembert.remedies import Advice, Insert, Remedy, at_place, remedies_in
from dalembert.text.wording import misspelt

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

MAX_LINES = 5
_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")


class UnknownKey(ValueError):
    """A key that the table does not define."""

    def __init__(self, key: str, names: Iterable[str], reason: str = ""):
        names = list(names)
        self.key = key
        super().__init__(
            reason
            or misspelt(
                "unknown key", key, names, f"; known here: {', '.join(names) or 'none'}", True
            )
        )


def key_path(*keys: str | int) -> str:
    """``joints.A.connect[1]``; keys that TOML would quote are quoted."""
    text = ""
    for key in keys:
        if isinstance(key, int):
            text += f"[{key}]"
            continue
        key = key if _BARE.match(key) else '"' + key[:60].encode("unicode_escape").decode() + '"'
        text += f".{key}" if text else key
    return text


def explain(error: ValidationError, data: dict, source: Path | str) -> ModelError:
    """All validation errors of a file as one ``ModelError``, one per line."""
    details = error.errors(include_url=False)
    lines = [
        f"{key_path(*_location(item, data)) or 'the file'}: {_description(item)}"
        for item in details
    ]
    remedies = [remedy for item in details for remedy in _remedies(item, data)]
    if len(lines) > MAX_LINES:
        lines[MAX_LINES:] = [f"… and {len(lines) - MAX_LINES} more"]
    text = lines[0] if len(lines) == 1 else "\n  ".join(["", *lines])
    return ModelError(Advice(text, remedies), str(source))


def _location(item: ErrorDetails, data: Any) -> list[str | int]:
    """Keys that lead to the error, without the type tags of the validator."""
    where: list[str | int] = []
    loc = item["loc"]
    for k, key in enumerate(loc):
        inside = isinstance(data, list) and isinstance(key, int) and key < len(data)
        if inside or (isinstance(data, dict) and key in data):
            data = data[key]
        elif item["type"] != "missing" or k != len(loc) - 1:
            continue
        where.append(key)
    cause = item.get("ctx", {}).get("error")
    return [*where, cause.key] if isinstance(cause, UnknownKey) else where


def _remedies(item: ErrorDetails, data: Any) -> tuple[Remedy, ...]:
    cause = item.get("ctx", {}).get("error")
    remedies = (Insert(),) if item["type"] == "missing" else remedies_in(cause)
    return at_place(key_path(*_location(item, data)), remedies)


def _description(item: ErrorDetails) -> str:
    kind, value = item["type"], item.get("input")
    cause = item.get("ctx", {}).get("error")
    if cause is not None:
        return str(cause)
    if kind == "missing":
        return "is missing; add it"
    if kind in ("dict_type", "model_type"):
        return f"expected a table, got {short_repr(value)}"
    if kind == "list_type":
        return f"expected a list, got {short_repr(value)}"
    return f"{item['msg']}, got {short_repr(value)}"
