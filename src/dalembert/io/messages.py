"""From what a checker says to what a person can mend: file, place, value, cure."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from dalembert.errors import ModelError
from dalembert.io.values import shown
from dalembert.text.wording import nearest

SHOWN = 5
_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")


class UnknownKey(ValueError):
    """A key that a table does not have."""

    def __init__(self, key: str, known: Iterable[str]):
        known = list(known)
        self.key = key
        super().__init__(
            f"unknown key{nearest(key, known)}; known here: {', '.join(known) or 'none'}"
        )


def place(*keys: str | int) -> str:
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
    """All that is wrong with a file, each on a line, as one error."""
    found = error.errors(include_url=False)
    lines = [f"{place(*_place_of(item, data)) or 'the file'}: {_sentence(item)}" for item in found]
    if len(lines) > SHOWN:
        lines[SHOWN:] = [f"… and {len(lines) - SHOWN} more"]
    return ModelError(lines[0] if len(lines) == 1 else "\n  ".join(["", *lines]), str(source))


def _place_of(item: Any, data: Any) -> list[str | int]:
    """The keys on the way to the error, without the types that the checker also tells."""
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


def _sentence(item: Any) -> str:
    kind, value = item["type"], item.get("input")
    cause = item.get("ctx", {}).get("error")
    if cause is not None:
        return str(cause)
    if kind == "missing":
        return "is missing; add it"
    if kind in ("dict_type", "model_type"):
        return f"expected a table, got {shown(value)}"
    if kind == "list_type":
        return f"expected a list, got {shown(value)}"
    return f"{item['msg']}, got {shown(value)}"
