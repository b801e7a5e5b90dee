"""Keys of a section of a model file, such as ``[analysis]``: written, replaced and removed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from dalembert.errors import ModelError
from dalembert.studio.toml_values import NAME, as_toml

if TYPE_CHECKING:
    from dalembert.studio.text_edits import TextEdits

SECTIONS = (
    *("analysis", "report", "responses", "optimize", "pareto", "tolerance", "reliability"),
    *("identify", "sweep", "synthesis"),
)
"""Sections that a form may change."""


def set_section(edits: TextEdits, section: str, fields: Mapping[str, Any]) -> None:
    """Give keys of a section new values; the section is added at the end if there is none.

    Parameters
    ----------
    edits : of the text
    section : such as ``analysis``
    fields : key → value; None removes the key with its tables

    Raises
    ------
    ModelError
        A section without a form, or an invalid key or value.
    """
    if section not in SECTIONS:
        raise ModelError(f"the section {section[:40]!r} is not changed by forms; edit the text")
    for key in fields:
        if not NAME.fullmatch(str(key)):
            raise ModelError(f"{str(key)[:60]!r} is no key", section)
    old = edits.data.get(section)
    values = {key: value for key, value in fields.items() if value is not None}
    if old is None:
        rows = "".join(f"{key} = {as_toml(value)}\n" for key, value in values.items())
        edits.append(f"[{section}]\n{rows}")
        return
    if not isinstance(old, dict):
        raise ModelError("is no table", section)
    for key, value in fields.items():
        if value is not None and old.get(key) == value:
            continue
        keys = (section, key)
        place = edits.places.get(keys)
        if value is not None and place is not None and not place.is_header:
            edits.replace(keys, value)
            continue
        if key in old:
            edits.remove(section, key)
        if value is not None:
            _add(edits, section, key, value)


def _add(edits: TextEdits, section: str, key: str, value: Any) -> None:
    if (section,) in edits.places:
        edits.set_value((section, key), value)
        return
    own = [place for keys, place in edits.places.items() if keys[0] == section]
    headers = any(place.is_header for place in own)
    if own and not headers:  # dotted keys
        edits.insert(section, False, f"{section}.{key} = {as_toml(value)}\n", "\n")
    elif own and isinstance(value, Mapping):  # tables below the section
        rows = "".join(f"{name} = {as_toml(item)}\n" for name, item in value.items())
        edits.insert(section, False, f"[{section}.{key}]\n{rows}", "\n\n")
    else:
        edits.append(f"[{section}]\n{key} = {as_toml(value)}\n")
