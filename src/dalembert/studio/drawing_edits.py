"""Changes of a model file that the drawing requests: new entries, values, names, removal."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

from dalembert.errors import ModelError
from dalembert.io.messages import key_path
from dalembert.studio.array_edits import append_item, insert_item, move_item, remove_item
from dalembert.studio.contact_edits import remove_group, without_shapes_of
from dalembert.studio.key_edits import drop_key
from dalembert.studio.list_edits import append_entry, remove_entry, remove_from_lists
from dalembert.studio.loose_nodes import loose_nodes
from dalembert.studio.region_edits import groups_after, merge_conditions, rename_groups
from dalembert.studio.section_edits import set_section
from dalembert.studio.text_edits import TextEdits

ELEMENTS = (
    *("bodies", "beams", "joints", "drivers", "forces", "blocks"),
    *("nodes", "elements", "meshes"),
)
"""Sections of elements, which refer to each other."""
MAX_OPERATIONS = 500
"""Upper limit of the operations of one change."""
PLACEHOLDER = re.compile(r"\$\w+")
"""Name that a later operation gives to an element of the same change."""


def apply(text: str, operations: Any) -> str:
    """The text after the operations of one change.

    Parameters
    ----------
    text : of the model file
    operations : list of tables with ``op``. ``add`` has ``section``, ``fields`` and ``name`` or
        ``base``, to which a number is appended; ``as`` is a placeholder such as ``$bar`` for the
        name in later operations. ``set`` has ``keys`` and ``value``, which with ``written``
        replaces formulas too. ``remove`` and ``rename`` have ``section`` and ``name``; the new
        name is ``to``, and an entry may be ``missing`` if another operation removes it. Nodes of
        a structure that lose their last element are removed with it.
        ``remove group`` has the ``name`` of collisions and the ``group``.
        ``parameter`` has ``name`` and ``value``, ``extract`` has ``keys``, or the character ``at``
        in the text. ``section`` has ``section`` and ``fields``: the new values of its keys, null
        for a removed one. ``append`` has ``section``, a list of tables such as ``supports``, and
        ``fields``; ``remove_entry`` has ``section`` and ``index``. ``append_item`` has the
        ``keys`` of an array and a ``value``, ``insert_item`` the ``keys`` of the item before which
        the ``value`` is inserted, ``remove_item`` the ``keys`` of an item,
        ``move_item`` also the number ``to`` that it gets.
        ``drop`` has the ``keys`` of a value that is removed from its table, if it is there,
        ``remove point`` those of a named point or frame, which takes along what refers to it.

    Raises
    ------
    ModelError
        An invalid operation; the text stays as it is.
    """
    if not isinstance(operations, list) or not 0 < len(operations) <= MAX_OPERATIONS:
        raise ModelError(f"a change has 1 to {MAX_OPERATIONS} operations")
    edits = TextEdits(text)
    names: dict[str, str] = {}
    for operation in operations:
        kind = operation.get("op") if isinstance(operation, dict) else None
        if not isinstance(kind, str) or kind not in OPERATIONS:
            raise ModelError(f"unknown operation {str(kind)[:40]!r}")
        OPERATIONS[kind](edits, _named(operation, names), names)
    return edits.text


def _named(value: Any, names: Mapping[str, str]) -> Any:
    """The value with names in place of placeholders."""
    if isinstance(value, str) and "$" in value:
        return PLACEHOLDER.sub(lambda match: names.get(match[0], match[0]), value)
    if isinstance(value, dict):
        return {key: item if key == "as" else _named(item, names) for key, item in value.items()}
    return [_named(item, names) for item in value] if isinstance(value, list) else value


def _text(operation: Mapping[str, Any], key: str) -> str:
    value = operation.get(key)
    if not isinstance(value, str):
        raise ModelError(f"the operation {operation.get('op')} needs the text {key!r}")
    return value


def _add(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    fields = operation.get("fields")
    place = _text(operation, "section") == "nodes"
    if not isinstance(fields, list if place else dict):
        raise ModelError(f"the operation add needs the {'list' if place else 'table'} 'fields'")
    name = operation.get("name") or edits.free_name(_text(operation, "base"))
    edits.add(_text(operation, "section"), str(name), fields)
    if "as" in operation:
        names[_text(operation, "as")] = str(name)


def _set(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    edits.set_value(_path(operation), operation.get("value"), operation.get("written") is True)


def _remove(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    section, name = _text(operation, "section"), _text(operation, "name")
    if operation.get("missing") is True and name not in edits.data.get(section, {}):
        return  # removed with an element of the same change
    if section in ELEMENTS:
        without_shapes_of(edits, _refers, name)
    loose_before = loose_nodes(edits.data)
    removed = [*dependents(edits.data, section, name), (section, name)]
    for entry in removed:
        edits.remove(*entry)
    unconnected = [node for node in loose_nodes(edits.data) if node not in loose_before]
    for node in unconnected:
        edits.remove("nodes", node)
    remove_from_lists(edits, {*unconnected, *(name for _, name in removed)})


def _rename(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    edits.rename(_text(operation, "section"), _text(operation, "name"), _text(operation, "to"))


def _parameter(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    edits.set_parameter(_text(operation, "name"), operation.get("value"))  # type: ignore[arg-type]


def _extract(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    keys, at = operation.get("keys"), operation.get("at")
    if isinstance(at, int):
        keys = edits.keys_at(at)
    if not (
        isinstance(keys, (list, tuple)) and keys and all(isinstance(k, (str, int)) for k in keys)
    ):
        raise ModelError("place the cursor in a number of an element")
    parts = [str(key) for key in keys[1:]]
    edits.extract(keys, re.sub(r"\W", "_", "_".join(parts)) or "parameter")


def _section(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    fields = operation.get("fields")
    if not isinstance(fields, dict):
        raise ModelError("the operation section needs the table 'fields'")
    set_section(edits, _text(operation, "section"), fields)


def _append(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    fields = operation.get("fields")
    if not isinstance(fields, dict):
        raise ModelError("the operation append needs the table 'fields'")
    append_entry(edits, _text(operation, "section"), fields)


def _remove_entry(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    index = operation.get("index")
    if not isinstance(index, int) or isinstance(index, bool):
        raise ModelError("the operation remove_entry needs the number 'index'")
    remove_entry(edits, _text(operation, "section"), index)


def _path(operation: Mapping[str, Any]) -> tuple[str | int, ...]:
    keys = operation.get("keys")
    if not (isinstance(keys, list) and keys and all(isinstance(k, (str, int)) for k in keys)):
        raise ModelError(f"the operation {operation.get('op')} needs the list 'keys'")
    return tuple(keys)


def _append_item(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    append_item(edits, _path(operation), operation.get("value"))


def _insert_item(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    keys, index = _item(operation)
    insert_item(edits, keys, index, operation.get("value"))


def _move_item(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    (keys, index), to = _item(operation), operation.get("to")
    if not isinstance(to, int) or isinstance(to, bool):
        raise ModelError("the operation move_item needs the number 'to'")
    move_item(edits, keys, index, to)


def _item(operation: Mapping[str, Any]) -> tuple[tuple[str | int, ...], int]:
    """Keys of an array, and the number of an item."""
    *keys, index = _path(operation)
    if not isinstance(index, int) or isinstance(index, bool):
        raise ModelError(f"the operation {operation.get('op')} needs the number of an item")
    return tuple(keys), index


def _remove_item(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    keys, index = _item(operation)
    groups = groups_after(edits.data, keys, index)
    gone = [f"{keys[1]}.{group}" for group, after in groups.items() if after is None]
    remove_from_lists(edits, gone)
    if groups:
        merge_conditions(edits, str(keys[1]), groups)
    remove_item(edits, keys, index)
    if groups:
        rename_groups(edits, str(keys[1]), groups)


def _drop(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    drop_key(edits, _path(operation))


def _remove_point(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    *owner, part, key = ("", *_path(operation))
    is_owner = owner[1:] == ["ground"] or (len(owner) == 3 and owner[1] == "bodies")
    if not is_owner or part not in ("points", "frames"):
        raise ModelError(
            "is no point or frame of a body or the ground", key_path(*owner[1:], part, key)
        )
    for section, name in dependents(edits.data, "bodies", f"{owner[-1]}.{key}"):
        _remove(edits, {"section": section, "name": name, "missing": True}, names)
    drop_key(edits, (*owner[1:], part, key))


def _remove_group(edits: TextEdits, operation: dict[str, Any], names: dict[str, str]) -> None:
    remove_group(edits, _text(operation, "name"), _text(operation, "group"))


OPERATIONS: dict[str, Callable[[TextEdits, dict[str, Any], dict[str, str]], None]] = {
    "add": _add,
    "set": _set,
    "remove": _remove,
    "remove group": _remove_group,
    "rename": _rename,
    "parameter": _parameter,
    "extract": _extract,
    "section": _section,
    "append": _append,
    "remove_entry": _remove_entry,
    "append_item": _append_item,
    "insert_item": _insert_item,
    "move_item": _move_item,
    "remove_item": _remove_item,
    "drop": _drop,
    "remove point": _remove_point,
}


def dependents(data: Mapping[str, Any], section: str, name: str) -> list[tuple[str, str]]:
    """Elements that cannot exist without an entry, directly or through others.

    Parameters
    ----------
    data : of the model file
    section, name : of the entry
    """
    if section not in ELEMENTS:
        return []
    removed = {name}
    listed: list[tuple[str, str]] = []
    waiting = [name]
    while waiting:
        former = waiting.pop()
        for other_section in ELEMENTS:
            entries = data.get(other_section)
            if not isinstance(entries, dict):
                continue
            for other, entry in entries.items():
                if other not in removed and _refers(entry, former):
                    removed.add(other)
                    listed.append((other_section, other))
                    waiting.append(other)
    return listed


def _refers(value: Any, name: str) -> bool:
    """Whether an entry refers to an element: by its name, its points or its measures."""
    if isinstance(value, str):
        return re.search(rf"(?<![\w.]){re.escape(name)}(?:\.|$)", value) is not None
    if isinstance(value, dict):
        return any(_refers(item, name) for item in value.values())
    return isinstance(value, list) and any(_refers(item, name) for item in value)
