"""Names in older model files, in their present form."""

from __future__ import annotations

import re
from typing import Any

_NODE = re.compile(r"\b(\w+)\.mesh_nodes(\d+)\b")


def with_present_names(data: dict[str, Any]) -> dict[str, Any]:
    """The data of a model file with ``mesh.mesh_nodes3`` of older files as ``mesh_nodes[3]``."""
    meshes = data.get("meshes")
    return _renamed(data, meshes) if isinstance(meshes, dict) else data


def _renamed(entry: Any, meshes: dict[str, Any]) -> Any:
    if isinstance(entry, dict):
        return {_renamed(key, meshes): _renamed(value, meshes) for key, value in entry.items()}
    if isinstance(entry, list):
        return [_renamed(value, meshes) for value in entry]
    if not isinstance(entry, str):
        return entry
    return _NODE.sub(lambda m: f"{m[1]}_nodes[{m[2]}]" if m[1] in meshes else m[0], entry)
