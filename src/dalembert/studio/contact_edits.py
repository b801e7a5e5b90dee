"""Shapes of ``Collisions`` in the text: a group less, or those of a body that is removed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dalembert.errors import ModelError
from dalembert.io.messages import key_path
from dalembert.studio.text_edits import TextEdits


def remove_group(edits: TextEdits, name: str, group: str) -> None:
    """Remove a group of shapes with the laws of its pairs.

    Raises
    ------
    ModelError
        There is no such group.
    """
    entry = edits.data.get("forces", {}).get(name)
    shapes = entry.get("shapes") if isinstance(entry, dict) else None
    if not isinstance(shapes, dict) or group not in shapes:
        raise ModelError("there is no such group", key_path("forces", name, "shapes", group))
    kept = {key: value for key, value in shapes.items() if key != group}
    _write(edits, name, entry, kept)


def without_shapes_of(edits: TextEdits, refers: Any, owner: str) -> None:
    """Remove the shapes of an element from elements that have others too.

    Parameters
    ----------
    refers : function of a shape and the name of the element, whether the shape refers to it
    owner : name of the element
    """
    for name, entry in list(edits.data.get("forces", {}).items()):
        if not isinstance(entry, dict) or entry.get("type") != "Collisions":
            continue
        shapes = entry.get("shapes")
        groups = {"": shapes} if isinstance(shapes, list) else shapes
        if not isinstance(groups, dict) or not refers(groups, owner):
            continue
        kept = {
            key: [shape for shape in group if not refers(shape, owner)]
            for key, group in groups.items()
            if isinstance(group, list)
        }
        kept = {key: group for key, group in kept.items() if group}
        if kept:
            _write(edits, name, entry, kept.get("", []) if isinstance(shapes, list) else kept)


def _write(edits: TextEdits, name: str, entry: Mapping[str, Any], shapes: Any) -> None:
    """Replace the shapes of an element, and the pairs of groups that it has no more."""
    fields = dict(entry) | {"shapes": shapes}
    pairs = fields.pop("pairs", None)
    if isinstance(pairs, list) and isinstance(shapes, dict):
        kept = [p for p in pairs if set(p.get("groups", ())) <= set(shapes)]
        fields |= {"pairs": kept} if kept else {}
    edits.remove("forces", name)
    edits.add("forces", name, fields)
