"""Shapes of ``Collisions`` in the text: a group less, or those of a body that is removed."""

from __future__ import annotations

from typing import Any

from dalembert.errors import ModelError
from dalembert.io.messages import key_path
from dalembert.io.toml_places import Keys
from dalembert.studio.array_edits import remove_item
from dalembert.studio.key_edits import cut
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
    cut(edits, ("forces", name, "shapes", group))
    _remove_pairs_without_groups(edits, name)


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
        keys, shapes = ("forces", name, "shapes"), entry.get("shapes")
        groups: dict[Keys, Any] = {keys: shapes} if isinstance(shapes, list) else {}
        if isinstance(shapes, dict):
            groups = {(*keys, key): group for key, group in shapes.items()}
        if not refers(list(groups.values()), owner):
            continue
        kept = {
            key: [shape for shape in group if not refers(shape, owner)]
            for key, group in groups.items()
            if isinstance(group, list)
        }
        if not any(kept.values()):
            continue
        for key, group in kept.items():
            if not group:
                cut(edits, key)
                continue
            for index in reversed(range(len(groups[key]))):
                if refers(groups[key][index], owner):
                    remove_item(edits, key, index)
        _remove_pairs_without_groups(edits, name)


def _remove_pairs_without_groups(edits: TextEdits, name: str) -> None:
    """Remove the pairs of groups that an element has no more."""
    keys, entry = ("forces", name, "pairs"), edits.data["forces"][name]
    pairs, shapes = entry.get("pairs"), entry.get("shapes")
    if not isinstance(pairs, list) or not isinstance(shapes, dict):
        return
    outdated = [
        index
        for index, pair in enumerate(pairs)
        if isinstance(pair, dict) and not set(pair.get("groups", ())) <= set(shapes)
    ]
    if len(outdated) == len(pairs):
        cut(edits, keys)
        return
    for index in reversed(outdated):
        remove_item(edits, keys, index)
