"""Orientations, frames and solids of a model file as Python code."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dalembert.io.exports.python.code import Code, call, literal, quoted, vector
from dalembert.io.orientations import FrameTable, GeometryTable

Write = Callable[[Any], str]


def _direction(entries: Any, write: Write) -> Code:
    return vector(write(entry) for entry in entries)


def orientation_code(entry: Any, write: Write) -> Code:
    """Call of a function of ``dalembert.rotation``."""
    arguments: dict[str, Callable[[], list[Any]]] = {
        "axis_angle": lambda: [_direction(entry.axis, write), write(entry.angle)],
        "euler": lambda: [quoted(entry.sequence), *map(write, entry.angles)],
        "bryant": lambda: [write(entry.x), write(entry.y), write(entry.z)],
        "from_matrix": lambda: [Code("[", [_direction(r, write) for r in entry.rows], "]")],
    }
    return call(f"rotation.{entry.type}", *arguments[entry.type]())


def frame_keywords(entry: FrameTable, write: Write) -> dict[str, Any]:
    """Keyword arguments of ``body.frame``."""
    keywords: dict[str, Any] = {"place": _direction(entry.at, write)}
    for key in ("axis", "x"):
        if getattr(entry, key) is not None:
            keywords[key] = _direction(getattr(entry, key), write)
    if entry.rotation is not None:
        keywords["rotation"] = orientation_code(entry.rotation, write)
    return keywords


def geometry_code(entry: GeometryTable) -> Code:
    """A solid that pictures show."""
    keywords = {
        key: literal(getattr(entry, key))
        for key in GeometryTable.model_fields
        if key in entry.model_fields_set
    }
    if entry.file is not None:
        keywords["file"] = f"HERE / {quoted(entry.file)}"
    return call("spatial.Geometry", **keywords)
