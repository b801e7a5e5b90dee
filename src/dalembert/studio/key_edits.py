"""Keys of tables in the text of a model file, added and removed with their values.

A table has a header, or is written in one line, ``a = { x = 1 }``, or by dotted keys, ``a.x = 1``.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from dalembert.errors import ModelError
from dalembert.io.messages import key_path
from dalembert.studio.toml_values import as_toml

if TYPE_CHECKING:
    from dalembert.io.toml_places import Keys, Place
    from dalembert.studio.toml_text import TomlText

LAST = re.compile(r"""(?:"(?:[^"\\]|\\.)*"|'[^']*'|[\w-]+)\s*=\s*$""", re.ASCII)
"""Last name of a dotted key, and the sign behind it."""


def drop_key(edits: TomlText, keys: Keys) -> None:
    """Remove a key of an entry; a missing one is no error.

    Parameters
    ----------
    edits : of the text
    keys : of the value

    Raises
    ------
    ModelError
        It is an entry itself.
    """
    if len(keys) < 3 and keys in edits.places:
        raise ModelError("is no key of an entry", key_path(*keys))
    cut(edits, keys)


def cut(edits: TomlText, keys: Keys) -> bool:
    """Remove a key with its value and tables; returns whether there was one."""
    text, ranges = edits.text, edits.ranges(keys)
    if ranges:
        for start, end in reversed(ranges):
            text = text[:start] + text[end:]
        edits.set_text(text)
        return True
    table = _inline_table(edits, keys)
    if table is None:
        return False
    while True:
        members = _members(edits, table)
        own = next((k for k, (key, _) in enumerate(members) if key[: len(keys)] == keys), None)
        if own is None:
            return True
        places = [place for _, place in members]
        start, end = places[own].start, places[own].end
        if own + 1 < len(places):
            end = places[own + 1].start
        elif own:
            start = places[own - 1].end
        edits.set_text(edits.text[:start] + edits.text[end:])


def _inline_table(edits: TomlText, keys: Keys) -> Keys | None:
    """Keys of the innermost table in one line that contains an entry."""
    if not any(key[: len(keys)] == keys for key in edits.places):
        return None
    tables = (keys[:k] for k in reversed(range(1, len(keys))))
    written = next((table for table in tables if table in edits.places), None)
    return None if written is None or edits.places[written].is_header else written


def _members(edits: TomlText, table: Keys) -> list[tuple[Keys, Place]]:
    """Keys of a table in one line with their places, in their order."""
    whole = edits.places[table]
    members: list[tuple[Keys, Place]] = []
    end = whole.value + 1
    for keys, place in edits.places.items():
        if end <= place.start < whole.end:
            members.append((keys, place))
            end = place.end
    return members


def add_dotted(edits: TomlText, keys: Keys, value: Any) -> bool:
    """Add a key to a table that is written by dotted keys; returns whether it is one."""
    outer = _inline_table(edits, keys[:-1])
    written = edits.statements.items() if outer is None else _members(edits, outer)
    siblings = [p for key, p in written if key[:-1] == keys[:-1] and not p.is_header]
    if not siblings:
        return False
    text, last = edits.text, siblings[-1]
    added = f"{LAST.sub('', text[last.start : last.value])}{keys[-1]} = {as_toml(value)}"
    if outer is not None:
        edits.set_text(f"{text[: last.end]}, {added}{text[last.end :]}")
        return True
    end = edits.line_end(last.end)
    gap = "" if text[:end].endswith("\n") else "\n"
    indent = text[text.rfind("\n", 0, last.start) + 1 : last.start]
    edits.set_text(f"{text[:end]}{gap}{indent}{added}\n{text[end:]}")
    return True
