"""Keys of values in the text of a model file: found at a character, removed with the value."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dalembert.errors import ModelError
from dalembert.io.messages import key_path

if TYPE_CHECKING:
    from dalembert.io.toml_places import Keys
    from dalembert.studio.text_edits import TextEdits


def keys_at(edits: TextEdits, at: int) -> Keys:
    """Keys of the innermost value at a character; empty if there is none."""
    inside = [
        (place.end - place.value, keys)
        for keys, place in edits.places.items()
        if place.start <= at <= place.end and keys
    ]
    return min(inside, default=(0, ()))[1]


def drop_key(edits: TextEdits, keys: Keys) -> None:
    """Remove a key of a table, in one line or with a header; a missing one is no error.

    Parameters
    ----------
    edits : of the text
    keys : of the value

    Raises
    ------
    ModelError
        The table is not written as one.
    """
    own, table = edits.places.get(keys), edits.places.get(keys[:-1])
    if own is None:
        return
    if table is None or len(keys) < 3:
        raise ModelError("is no key of an entry", key_path(*keys))
    text = edits.text
    if table.value == table.start:  # a table with a header
        start, end = edits.ranges(keys)[0]
        edits.set_text(text[:start] + text[end:])
        return
    others = [p for k, p in edits.places.items() if k[:-1] == keys[:-1] and k != keys]
    behind = [place.start for place in others if place.start > own.start]
    before = [place.end for place in others if place.end <= own.start]
    start = own.start if behind or not before else max(before)
    end = min(behind, default=own.end)
    edits.set_text(text[:start] + text[end:])
