"""Names of corners, edges and holes of a region, whose numbers change when one is removed."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from dalembert.errors import ModelError
from dalembert.io.messages import key_path
from dalembert.studio.list_edits import LISTS, REFERENCES, remove_from_entry

if TYPE_CHECKING:
    from dalembert.io.toml_places import Keys
    from dalembert.studio.text_edits import TextEdits

Groups = dict[str, str | None]
"""Group of nodes of a region, such as ``edge2`` → its name afterwards, none where it is gone."""


def groups_after(data: Mapping[str, Any], keys: Keys, index: int) -> Groups:
    """Groups whose names change when an item of an array is removed.

    The edges on both sides of a corner become one.

    Parameters
    ----------
    data : of the model file
    keys : of the array
    index : of the item
    """
    if len(keys) != 4 or keys[0] != "meshes" or keys[2] != "polygon":
        return {}
    entry: Any = data
    for key in keys:
        entry = entry.get(key) if isinstance(entry, dict) else None
    count, removed = len(entry) if isinstance(entry, list) else 0, index + 1
    numbers = range(removed, count + 1)
    if not 0 < removed <= count:
        return {}
    kind = {"holes": "hole", "vertices": "vertex"}.get(str(keys[3]))
    if kind is None:
        return {}
    groups: Groups = {f"{kind}{k}": f"{kind}{k - 1}" if k > removed else None for k in numbers}
    if kind == "hole":
        return groups
    groups |= {f"edge{k}": f"edge{k - 1}" for k in numbers}
    if removed == 1:  # the first edge becomes a part of the last one
        groups["edge1"] = f"edge{count - 1}"
    return groups


def merge_conditions(edits: TextEdits, mesh: str, groups: Groups) -> None:
    """Keep one of two equal supports or loads at edges that become one, where both would add up.

    Parameters
    ----------
    edits : of the text
    mesh : name of the region
    groups : by ``groups_after``

    Raises
    ------
    ModelError
        The edges have different loads of one kind.
    """
    gone = next((k for k, after in groups.items() if k[:6] == "vertex" and after is None), None)
    if gone is None:
        return
    corner, count = int(gone[6:]), sum(name.startswith("edge") for name in groups)
    second = f"edge{corner}"
    first = f"edge{corner - 1 if corner > 1 else count}"
    for section in LISTS:
        entries = edits.data.get(section)
        entries = [e for e in entries if isinstance(e, dict)] if isinstance(entries, list) else []
        at_first, at_second = (
            [k for k, e in enumerate(entries) if _is_at(e, mesh, edge) > _is_at(e, mesh, other)]
            for edge, other in ((first, second), (second, first))
        )
        equal = []
        for k in at_second:
            same = [j for j in at_first if _values(entries[j]) == _values(entries[k])]
            if same:
                at_first.remove(same[0])
                equal.append(k)
            elif section != "supports":
                _need_no_other(section, mesh, (first, second), entries[k], entries, at_first)
        for k in reversed(equal):
            remove_from_entry(edits, section, k, {f"{mesh}.{second}"})


def _is_at(entry: dict[str, Any], mesh: str, edge: str) -> bool:
    listed = entry.get("nodes", [])
    return f"{mesh}.{edge}" in (listed if isinstance(listed, list) else [listed])


def _values(entry: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in entry.items() if key != "nodes"}


def _need_no_other(
    section: str,
    mesh: str,
    edges: tuple[str, str],
    entry: dict[str, Any],
    entries: list[dict[str, Any]],
    others: list[int],
) -> None:
    """Raise an error if loads of one kind at two edges differ."""
    for k in others:
        if entries[k].get("case") != entry.get("case"):
            continue
        shared = (_values(entry).keys() & _values(entries[k]).keys()) - {"case", "elements"}
        if shared:
            raise ModelError(
                f"{edges[0]} and {edges[1]} of {mesh} become one edge without this corner, and "
                f"their {section} differ in {', '.join(sorted(shared))}; make them equal or delete "
                "one of them first",
                key_path("meshes", mesh, "polygon", "vertices"),
            )


def rename_groups(edits: TextEdits, mesh: str, groups: Groups) -> None:
    """Write the new names of groups of nodes into all values of the text.

    Parameters
    ----------
    edits : of the text
    mesh : name of the region
    groups : by ``groups_after``
    """
    word = re.compile(rf"(?<![\w.]){re.escape(mesh)}\.((?:vertex|edge|hole)\d+)(?!\w)")
    spans: dict[tuple[int, int], str] = {}
    for place in edits.places.values():
        value = edits.text[place.value : place.end]
        if value[:1] in ('"', "'"):
            for match in word.finditer(value):
                after = groups.get(match[1])
                if after is not None:
                    spans[place.value + match.start(1), place.value + match.end(1)] = after
    text = edits.text
    for (start, end), after in sorted(spans.items(), reverse=True):
        text = text[:start] + after + text[end:]
    edits.set_text(text)
    _name_once(edits)


def _name_once(edits: TextEdits) -> None:
    """Name edges once where two that were listed have become one."""
    for section in LISTS:
        entries = edits.data.get(section)
        for index, entry in enumerate(entries if isinstance(entries, list) else ()):
            for key in REFERENCES:
                listed = entry.get(key) if isinstance(entry, dict) else None
                if not isinstance(listed, list):
                    continue
                once = list(dict.fromkeys(map(str, listed)))
                if len(once) < len(listed):
                    edits.replace((section, index, key), once[0] if len(once) == 1 else once)
