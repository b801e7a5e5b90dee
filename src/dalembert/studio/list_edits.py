"""Lists of tables of a model file, such as ``[[supports]]``: entries added and removed."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Set
from typing import TYPE_CHECKING, Any

from dalembert.errors import ModelError
from dalembert.io.messages import key_path
from dalembert.studio.array_edits import append_item, remove_item
from dalembert.studio.toml_values import NAME, as_toml

if TYPE_CHECKING:
    from dalembert.studio.text_edits import TextEdits

LISTS = {
    "supports": "nodes",
    "loads": "nodes",
    "line_loads": "elements",
    "tractions": "nodes",
    "temperatures": "elements",
}
"""Lists that the drawing changes, and the key of the names of their parts."""
REFERENCES = ("nodes", "elements")
"""Keys of names of nodes, elements and meshes in these and other lists."""
OTHERS = ("initial",)
"""Further lists that refer to nodes and elements."""


def append_entry(edits: TextEdits, section: str, fields: Mapping[str, Any]) -> None:
    """Add a table at the end of a list, in the style of its other tables.

    Parameters
    ----------
    edits : of the text
    section : such as ``supports``
    fields : key → value

    Raises
    ------
    ModelError
        Another section, or an invalid key or value.
    """
    if section not in LISTS:
        raise ModelError("tables cannot be added to this section", section)
    for key in fields:
        if not NAME.fullmatch(str(key)):
            raise ModelError(f"{str(key)[:60]!r} is no key", section)
    place = edits.places.get((section,))
    if place is None:
        rows = "".join(f"{key} = {as_toml(value)}\n" for key, value in fields.items())
        edits.insert(section, False, f"[[{section}]]\n{rows}", "\n\n")
        return
    append_item(edits, (section,), dict(fields))


def remove_entry(edits: TextEdits, section: str, index: int) -> None:
    """Remove a table of a list.

    Raises
    ------
    ModelError
        There is none of this number.
    """
    entries = edits.data.get(section)
    if section not in (*LISTS, *OTHERS) or not isinstance(entries, list):
        raise ModelError("tables cannot be removed from this section", section)
    if not 0 <= index < len(entries):
        raise ModelError("there is no such table", key_path(section, index))
    text, place = edits.text, edits.places.get((section,))
    if place is None:
        ranges = edits.ranges((section, index))
        for start, end in sorted(ranges, reverse=True):
            text = text[:start] + text[end:]
        edits.set_text(text)
        return
    remove_item(edits, (section,), index)


def remove_from_lists(edits: TextEdits, names: Collection[str]) -> None:
    """Remove nodes, elements and meshes from lists; tables of these only are removed.

    Parameters
    ----------
    edits : of the text
    names : of the removed parts, or of groups of nodes of a mesh, such as ``plate.edge2``
    """
    names = set(names)
    for section in (*LISTS, *OTHERS):
        entries = edits.data.get(section)
        for index in reversed(range(len(entries) if isinstance(entries, list) else 0)):
            remove_from_entry(edits, section, index, names)


def remove_from_entry(edits: TextEdits, section: str, index: int, names: Set[str]) -> None:
    """Remove nodes, elements and meshes from a table of a list; one of these only is removed.

    Parameters
    ----------
    edits : of the text
    section, index : of the table
    names : as of ``remove_from_lists``
    """
    entry = edits.data[section][index]
    for key in REFERENCES if isinstance(entry, dict) else ():
        old = entry.get(key, [])
        listed = old if isinstance(old, list) else [old]
        kept = [name for name in listed if names.isdisjoint(_names_of(name))]
        if listed and not kept:
            remove_entry(edits, section, index)
            return
        if kept != listed:
            edits.replace((section, index, key), kept[0] if len(kept) == 1 else kept)


def _names_of(reference: Any) -> tuple[str, str]:
    """Names of the part to which an item of a list belongs: of the item itself, and of its mesh."""
    return str(reference), str(reference).partition(".")[0]
