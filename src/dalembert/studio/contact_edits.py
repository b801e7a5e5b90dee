"""Shapes of ``Collisions`` in the text: a group less, or those of a body that is removed."""

from __future__ import annotations

from collections.abc import Sequence
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
    _drop_pairs(edits, name, set(shapes) - {group})


def remove_shape(edits: TextEdits, name: str, group: str, index: int) -> None:
    """Remove a shape of a group, or of the list without groups, which has others.

    Raises
    ------
    ModelError
        There is no such shape.
    """
    shapes = edits.data.get("forces", {}).get(name, {}).get("shapes")
    keys: Keys = ("forces", name, "shapes", *([group] if group else []))
    listed = shapes.get(group) if isinstance(shapes, dict) else shapes
    if not isinstance(listed, list) or not 0 <= index < len(listed):
        raise ModelError("there is no such shape", key_path(*keys, index))
    _keep_items(edits, keys, [k != index for k in range(len(listed))])


def set_list(edits: TextEdits, keys: Keys, value: Any) -> None:
    """Replace a list, written as an array or as tables, by an array."""
    place = edits.places.get(keys)
    if place is not None and not place.is_header:
        edits.replace(keys, value)
        return
    outer: Any = edits.data
    for key in keys[:-1]:
        outer = outer.get(key, {})
    cut(edits, keys)
    if keys[:-1] in edits.places or len(keys) < 4:
        edits.set_value(keys, value)
    else:  # a table without a header, such as of [[forces.hits.shapes.a]]
        set_list(edits, keys[:-1], dict(outer) | {keys[-1]: value})


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
            key: [not refers(shape, owner) for shape in group]
            for key, group in groups.items()
            if isinstance(group, list)
        }
        if not any(map(any, kept.values())):
            continue  # it is removed with its last shapes
        keys: Keys = ("forces", name, "shapes")
        for key, group in kept.items():
            _keep_items(edits, keys if isinstance(shapes, list) else (*keys, key), group)
        if isinstance(shapes, dict):
            _drop_pairs(edits, name, {key for key, group in kept.items() if any(group)})


def _drop_pairs(edits: TextEdits, name: str, groups: set[str]) -> None:
    """Remove the pairs of an element that are not of these groups."""
    pairs = edits.data["forces"][name].get("pairs")
    if isinstance(pairs, list):
        kept = [set(pair.get("groups", ())) <= groups for pair in pairs]
        _keep_items(edits, ("forces", name, "pairs"), kept)


def _keep_items(edits: TextEdits, keys: Keys, kept: Sequence[bool]) -> None:
    """Remove items of a list, written as an array or as tables; an empty list with its key."""
    if all(kept):
        return
    value: Any = edits.data
    for key in keys:
        value = value[key]
    place = edits.places.get(keys)
    if any(kept) and place is not None and not place.is_header:
        for index in reversed(range(len(kept))):
            if not kept[index]:
                remove_item(edits, keys, index)
        return
    if any(kept):
        set_list(edits, keys, [item for item, keep in zip(value, kept, strict=True) if keep])
    else:
        cut(edits, keys)
