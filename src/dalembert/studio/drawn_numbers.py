"""Numbers of a drawing as parameters of its live picture: a drag is computed in the page."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any

LIMIT = 300
"""Upper limit of such numbers; a larger model is built again after a drag."""
Keys = tuple[str | int, ...]
CONDITIONS = {
    "loads": {"fx": "N", "fy": "N", "mz": "N m"},
    "line_loads": {"qx": "N/m", "qy": "N/m"},
    "tractions": {"tx": "Pa", "ty": "Pa", "pressure": "Pa"},
}
"""Lists of loads whose values are numbers of the drawing, with their units."""


def with_drawn_parameters(data: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Keys]]:
    """The model with a parameter for each number of its drawing: lengths, angles and coordinates.

    Formulas and names of parameters stay as they are.

    Parameters
    ----------
    data : sections of a mechanism or a structure

    Returns
    -------
    data : with further parameters; the same if there are none, or too many
    places : name of such a parameter → keys of its number
    """
    places = dict(_numbers(data))
    if not 0 < len(places) <= LIMIT:
        return data, {}
    drawn = copy.deepcopy(data)
    parameters = drawn.setdefault("parameters", {})
    if not isinstance(parameters, dict):
        return data, {}
    names: dict[str, Keys] = {}
    for keys, unit in places.items():
        name = f"drawn_{len(names) + 1}"
        while name in parameters or name in data.get("derived", {}):
            name += "_"
        *parents, last = keys
        entry: Any = drawn
        for key in parents:
            entry = entry[key]
        parameters[name] = {"value": entry[last], "unit": unit}
        entry[last] = name
        names[name] = keys
    return drawn, names


def _numbers(data: dict[str, Any]) -> Iterator[tuple[Keys, str]]:
    """Keys and unit of each number of the drawing."""
    if data.get("kind") == "structure":
        yield from _structure_numbers(data)
        return
    for name, body in _tables(data, "bodies"):
        for key, unit in (("length", "m"), ("angle", "rad")):
            if _is_number(body.get(key)):
                yield ("bodies", name, key), unit
        yield from _coordinates(("bodies", name, "position"), body.get("position"))
        yield from _rotation(("bodies", name, "rotation"), body.get("rotation"))
        yield from _places(("bodies", name), body)
    ground = data.get("ground")
    if isinstance(ground, dict):
        yield from _places(("ground",), ground)
    for section in ("joints", "forces"):
        for name, element in _tables(data, section):
            ends = element.get("connect")
            for k, end in enumerate(ends if isinstance(ends, list) else ()):
                if isinstance(end, dict):
                    yield from _coordinates((section, name, "connect", k, "at"), end.get("at"))


def _places(owner: Keys, body: dict[str, Any]) -> Iterator[tuple[Keys, str]]:
    """Coordinates of points and frames of a body, or of the ground."""
    for point, place in _tables(body, "points", lists=True):
        yield from _coordinates((*owner, "points", point), place)
    for frame, entry in _tables(body, "frames"):
        yield from _coordinates((*owner, "frames", frame, "at"), entry.get("at"))


def _rotation(keys: Keys, table: Any) -> Iterator[tuple[Keys, str]]:
    """Axis and angles of the rotation of a spatial body."""
    kind = table.get("type") if isinstance(table, dict) else None
    if kind == "axis_angle":
        yield from _coordinates((*keys, "axis"), table.get("axis"), "")
    for key in {"axis_angle": ("angle",), "bryant": ("x", "y", "z")}.get(str(kind), ()):
        if _is_number(table.get(key)):
            yield (*keys, key), "rad"


def _structure_numbers(data: dict[str, Any]) -> Iterator[tuple[Keys, str]]:
    """Keys and unit of places of nodes and vertices, and of loads."""
    for name, place in _tables(data, "nodes", lists=True):
        yield from _coordinates(("nodes", name), place)
    for name, mesh in _tables(data, "meshes"):
        region, keys = mesh.get("polygon"), ("meshes", name, "polygon")
        if not isinstance(region, dict):
            continue
        yield from _loop((*keys, "vertices"), region.get("vertices"))
        holes = region.get("holes")
        for k, hole in enumerate(holes if isinstance(holes, list) else ()):
            if isinstance(hole, dict):
                yield from _coordinates((*keys, "holes", k, "center"), hole.get("center"))
                if _is_number(hole.get("radius")):
                    yield (*keys, "holes", k, "radius"), "m"
            else:
                yield from _loop((*keys, "holes", k), hole)
    for section, units in CONDITIONS.items():
        entries = data.get(section)
        for k, entry in enumerate(entries if isinstance(entries, list) else ()):
            for key, unit in units.items() if isinstance(entry, dict) else ():
                if _is_number(entry.get(key)):
                    yield (section, k, key), unit


def _loop(keys: Keys, places: Any) -> Iterator[tuple[Keys, str]]:
    for k, place in enumerate(places if isinstance(places, list) else ()):
        yield from _coordinates((*keys, k), place)


def _tables(data: dict[str, Any], section: str, lists: bool = False) -> Iterator[tuple[str, Any]]:
    entries = data.get(section)
    for name, entry in entries.items() if isinstance(entries, dict) else ():
        if isinstance(entry, list if lists else dict):
            yield name, entry


def _coordinates(keys: Keys, place: Any, unit: str = "m") -> Iterator[tuple[Keys, str]]:
    if isinstance(place, list) and len(place) in (2, 3):
        for i, value in enumerate(place):
            if _is_number(value):
                yield (*keys, i), unit


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
