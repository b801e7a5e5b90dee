"""Keys of tables in the text of a model file, removed with their values."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dalembert.errors import ModelError
from dalembert.io.messages import key_path

if TYPE_CHECKING:
    from dalembert.io.toml_places import Keys
    from dalembert.studio.text_edits import TextEdits


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
