"""Parts of a structure that is being drawn: nodes without elements are left out of its picture."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

MECHANISM = ("bodies", "beams", "include")
"""Sections of the bodies of a mechanism; without any, the picture is blank."""
STRUCTURE = ("elements", "meshes")
"""Sections of the elements of a structure."""
CONDITIONS = ("supports", "loads", "initial")
"""Lists of conditions at nodes."""


def parts_of(data: dict[str, Any]) -> tuple[str, ...]:
    """Sections of what is drawn."""
    return STRUCTURE if data.get("kind") == "structure" else MECHANISM


def loose_nodes(data: Mapping[str, Any]) -> list[str]:
    """Names of the nodes of a structure that no element connects; mechanisms have none."""
    nodes, elements = data.get("nodes"), data.get("elements", {})
    if data.get("kind") != "structure" or not isinstance(nodes, dict):
        return []
    ends = [
        entry.get("connect")
        for entry in (elements.values() if isinstance(elements, dict) else ())
        if isinstance(entry, dict)
    ]
    used = {str(name) for end in ends if isinstance(end, list) for name in end}
    return [name for name in nodes if name not in used]


def without_loose_nodes(data: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """The structure without nodes that no element connects, and the names of these nodes.

    Parameters
    ----------
    data : sections of a file; mechanisms stay as they are
    """
    loose = loose_nodes(data)
    if not loose:
        return data, []
    nodes = {name: place for name, place in data["nodes"].items() if name not in loose}
    rest = data | {"nodes": nodes}
    for section in CONDITIONS:
        entries = data.get(section)
        if isinstance(entries, list):
            rest[section] = [kept for entry in entries if (kept := _kept(entry, loose)) is not None]
    return rest, loose


def _kept(entry: Any, loose: list[str]) -> Any:
    """A condition without these nodes; None if it has no others."""
    names = entry.get("nodes") if isinstance(entry, dict) else None
    listed = names if isinstance(names, list) else [names]
    kept = [name for name in listed if name not in loose]
    return entry | {"nodes": kept} if kept and kept != listed else entry if kept else None
