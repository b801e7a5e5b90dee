"""Text that is shown: on a terminal, in a result file, on a page; names that are not known."""

from __future__ import annotations

import difflib
import json
import math
import re
from collections.abc import Iterable
from typing import Any

from dalembert.errors import ModelError

HIDDEN = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff\ud800-\udfff]"
)
"""Control characters but tab and line end, marks that turn the direction of text, separators of
lines that are not seen as such, lone surrogates."""


LONGEST_NAME = 200
"""Characters of a name; tables, pages and files repeat it for every quantity."""
MOST = 24
"""Names that a message lists."""


def visible(text: str) -> str:
    """The text, with what is not seen or acts on a terminal as ``\\x1b``, ``\\u202e``."""
    return HIDDEN.sub(lambda found: found[0].encode("unicode_escape").decode(), text)


def check_length(name: str, owner: str) -> None:
    """Refuse a name that no table or page can show.

    Raises
    ------
    ModelError
        States the first characters, the length and the limit.
    """
    if len(name) > LONGEST_NAME:
        raise ModelError(
            f"the name '{visible(name[:40])}…' has {len(name)} characters; {LONGEST_NAME} at most",
            owner,
        )


def plain_text(text: Any, entity: str) -> str:
    """A text that can be shown anywhere.

    Raises
    ------
    ModelError
        No text, or one with a hidden character; names the entity and the character.
    """
    if not isinstance(text, str):
        raise ModelError(f"expected a text, got {text!r:.60}", entity)
    found = HIDDEN.search(text)
    if found:
        raise ModelError(
            f"the text '{visible(text[:60])}' has the hidden character U+{ord(found[0]):04X} at "
            f"place {found.start() + 1}; remove it",
            visible(entity),
        )
    return text


def as_document(data: Any) -> str:
    """JSON; null where a number is not finite, and hidden characters as ``\\u202e``."""
    text = json.dumps(plain(data), indent=2, ensure_ascii=False, allow_nan=False)
    return HIDDEN.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def plain(data: Any) -> Any:
    """Built-in types only."""
    if isinstance(data, dict):
        return {str(key): plain(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [plain(item) for item in data]
    if hasattr(data, "tolist"):
        return plain(data.tolist())
    if isinstance(data, float):
        return data if math.isfinite(data) else None
    return data if data is None or isinstance(data, (bool, int, str)) else str(data)


def nearest(name: Any, known: Iterable[str]) -> str:
    """``(did you mean …?)`` if something known is close."""
    # two letters of which one is right are near enough for short names
    close = difflib.get_close_matches(str(name)[:80], list(known), 1, 0.5)
    return f" (did you mean {close[0]!r}?)" if close else ""


def unknown(what: str, name: Any, known: Iterable[str]) -> str:
    """``unknown body 'crnk' (did you mean 'crank'?); known: ground, crank``."""
    names = list(known)
    return f"unknown {what} {name!r}{nearest(name, names)}; known: {listed(names)}"


def listed(names: Iterable[str]) -> str:
    """The first of them with commas between."""
    names = list(names)
    return (", ".join(names[:MOST]) + (", …" if len(names) > MOST else "")) or "none"
