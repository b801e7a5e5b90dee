"""Arrays in the text of a model file: items added and removed, comments of the others kept.

An array is a value, ``a = [1, 2]``, or consists of tables with a header ``[[a]]`` each.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from dalembert.errors import ModelError
from dalembert.io.messages import key_path
from dalembert.studio.key_edits import cut
from dalembert.studio.toml_values import as_toml

if TYPE_CHECKING:
    from dalembert.io.toml_places import Keys
    from dalembert.studio.text_edits import TextEdits

COMMA = re.compile(r"(?:\s|#[^\n]*\n)*,")
"""What may precede the comma behind an item."""
BEHIND = re.compile(r"([ \t]*,)?([ \t]*#[^\n]*)?")
"""Comma behind an item, and the comment in its line."""


def append_item(edits: TextEdits, keys: Keys, value: Any) -> None:
    """Add an item at the end of an array, on a line of its own where the last one has its own.

    Parameters
    ----------
    edits : of the text
    keys : of the array; a missing one is added to its table

    Raises
    ------
    ModelError
        It is no array, or the value is invalid.
    """
    place = edits.places.get(keys)
    if place is None:
        if _has_headers(edits, keys):
            _append_table(edits, keys, value)
        else:
            edits.set_value(keys, [value])
        return
    count, text = len(_items(edits, keys)), edits.text
    if not count:
        at = place.value + 1
        edits.set_text(text[:at] + as_toml(value) + text[at:])
        return
    last = edits.places[*keys, count - 1]
    behind = text[last.end : place.end - 1]
    if not (_begins_line(text, last.start) and "\n" in behind):
        edits.set_text(f"{text[: last.end]}, {as_toml(value)}{text[last.end :]}")
        return
    comma = COMMA.match(behind) is not None
    line = text.rfind("\n", 0, last.start) + 1
    end = text.find("\n", last.end)
    new = f"\n{text[line : last.start]}{as_toml(value)}{',' if comma else ''}"
    between = ("" if comma else ",") + text[last.end : end]
    edits.set_text(text[: last.end] + between + new + text[end:])


def insert_item(edits: TextEdits, keys: Keys, index: int, value: Any) -> None:
    """Insert an item of an array before another one, or at its end.

    Raises
    ------
    ModelError
        It is no array that is a value, there is no item of this number, or the value is invalid.
    """
    count = len(_items(edits, keys))
    if not 0 <= index <= count:
        raise ModelError("there is no such item", key_path(*keys, index))
    if index == count:
        append_item(edits, keys, value)
        return
    if keys not in edits.places:
        raise ModelError("tables with headers are only added at the end", key_path(*keys))
    text, at = edits.text, edits.places[*keys, index].start
    indent = text[text.rfind("\n", 0, at) + 1 : at]
    gap = " " if indent.strip() else f"\n{indent}"
    edits.set_text(f"{text[:at]}{as_toml(value)},{gap}{text[at:]}")


def remove_item(edits: TextEdits, keys: Keys, index: int) -> None:
    """Remove an item of an array, with the comment in its line.

    Raises
    ------
    ModelError
        It is no array, or there is no item of this number.
    """
    count = len(_items(edits, keys))
    if not 0 <= index < count:
        raise ModelError("there is no such item", key_path(*keys, index))
    if keys not in edits.places:
        cut(edits, (*keys, index))
        return
    text, own = edits.text, edits.places[*keys, index]
    if index + 1 < count:
        start, end = own.start, edits.places[*keys, index + 1].start
    elif index and _begins_line(text, own.start):
        start = text.rfind("\n", 0, own.start)
        end = min(text.find("\n", own.end), edits.places[keys].end - 1)
    else:
        start = edits.places[*keys, index - 1].end if index else own.start
        end = own.end
    edits.set_text(text[:start] + text[end:])


def move_item(edits: TextEdits, keys: Keys, index: int, to: int) -> None:
    """Move an item of an array that is a value to another number, with the comment in its line.

    Raises
    ------
    ModelError
        It is no such array, or there is no item of one of the numbers.
    """
    count = len(_items(edits, keys))
    if keys not in edits.places or not (0 <= index < count and 0 <= to < count):
        raise ModelError("there is no such item", key_path(*keys, index))
    text, end = edits.text, edits.places[keys].end - 1
    places = [edits.places[*keys, k] for k in range(count)]
    stops = [place.start for place in places[1:]] + [end]
    behind = [BEHIND.match(text, p.end, stop) for p, stop in zip(places, stops, strict=True)]
    ends_line = all(match and text[match.end()] == "\n" for match in behind)
    items = [text[place.start : place.end] for place in places]
    comments = [(match[2] or "") if match and ends_line else "" for match in behind]
    order = [k for k in range(count) if k != index]
    order.insert(to, index)
    new, at = "", 0
    for k, (place, match) in enumerate(zip(places, behind, strict=True)):
        new += text[at : place.start] + items[order[k]]
        at = place.end
        if match and ends_line:
            new += (match[1] or "") + comments[order[k]]
            at = match.end()
    edits.set_text(new + text[at:])


def _has_headers(edits: TextEdits, keys: Keys) -> bool:
    """Whether an array consists of tables with a header each."""
    first = edits.places.get((*keys, 0))
    return keys not in edits.places and first is not None and first.is_header


def _append_table(edits: TextEdits, keys: Keys, value: Any) -> None:
    """Add a table with its own header behind the others of an array."""
    if not isinstance(value, dict):
        raise ModelError("consists of tables; add a table", key_path(*keys))
    last = (*keys, len(_items(edits, keys)) - 1)
    place, text = edits.places[last], edits.text
    at, header = edits.ranges(last)[-1][1], text[place.start : place.end]
    rows = "".join(f"{name} = {as_toml(item)}\n" for name, item in value.items())
    before, after = text[:at].rstrip("\n"), text[at:].lstrip("\n")
    edits.set_text(f"{before}\n\n{header}\n{rows}" + (f"\n{after}" if after else ""))


def _items(edits: TextEdits, keys: Keys) -> list[Any]:
    """Items of an array."""
    value: Any = edits.data
    for key in keys if keys in edits.places or _has_headers(edits, keys) else ():
        value = value[key]
    if not isinstance(value, list):
        raise ModelError("is no array", key_path(*keys))
    return value


def _begins_line(text: str, at: int) -> bool:
    """Whether only space precedes a character in its line."""
    return not text[text.rfind("\n", 0, at) + 1 : at].strip()
