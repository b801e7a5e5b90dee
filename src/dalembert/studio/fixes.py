"""Remedies of errors as replacements in the text."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from dalembert.errors import DalembertError
from dalembert.io.toml_places import Keys, Place
from dalembert.studio.text_edits import TextEdits
from dalembert.studio.toml_values import as_toml
from dalembert.text.wording import suggestion_in

MISSING = re.compile(r"is missing; (?:add it|give it)")
ADDED = re.compile(r'\b(kind = "structure"|dimension = [23])(?= it is valid|$)')
VALUES: dict[str, Any] = {
    "format": 1,
    "connect": ["ground", "ground"],
    "law": "t",
    "duration": 1.0,
}
"""Missing key → the value with which it is inserted; numbers are one."""


@dataclass(frozen=True)
class Fix:
    """A replacement in the text.

    Attributes
    ----------
    title : of its button
    start, end : characters that are replaced
    insert : text in their place
    """

    title: str
    start: int
    end: int
    insert: str


def fixes_of(message: str, keys: Keys, places: Mapping[Keys, Place], text: str) -> tuple[Fix, ...]:
    """Remedies that an error states.

    Parameters
    ----------
    message : of the error
    keys : at which it is; they may be missing in the text
    places : of the keys in the text
    text : of the model file
    """
    suggestion = suggestion_in(message)
    if suggestion is not None:
        return _replacement(*suggestion, keys, places, text)
    if MISSING.search(message) and keys and isinstance(keys[-1], str):
        return _insertion(keys, VALUES.get(keys[-1], 1.0), text)
    added = ADDED.search(message)
    if added:
        key, _, value = added[1].partition(" = ")
        return _insertion((key,), int(value) if value.isdigit() else value.strip('"'), text)
    return ()


def _replacement(
    wrong: str, right: str, keys: Keys, places: Mapping[Keys, Place], text: str
) -> tuple[Fix, ...]:
    """Replace a name at the place of an error, or in its key."""
    while keys and keys not in places:
        keys = keys[:-1]
    if not keys:
        return ()
    name = re.escape(wrong or str(keys[-1]))
    place = places[keys]
    word = re.compile(rf"(?<![\w.]){name}(?!\w)")
    match = word.search(text, place.start, place.end) or word.search(text, place.start)
    if match is None:
        return ()
    return (Fix(f"Write {right}", match.start(), match.end(), right),)


def _insertion(keys: Keys, value: Any, text: str) -> tuple[Fix, ...]:
    """Add a key to its table."""
    if len(keys) == 1:
        insert = f"{keys[0]} = {as_toml(value)}\n"
        return (Fix(f"Insert {insert.strip()}", 0, 0, insert),)
    try:
        edits = TextEdits(text)
        edits.set_value(keys, value)
    except DalembertError:
        return ()
    start = next(
        (k for k, (a, b) in enumerate(zip(text, edits.text, strict=False)) if a != b), len(text)
    )
    added = len(edits.text) - len(text)
    title = f"Insert {keys[-1]} = {as_toml(value)}"
    return (Fix(title, start, start, edits.text[start : start + added]),)
