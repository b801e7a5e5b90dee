"""Numbers of a drawing as parameters of its live picture: a drag is computed in the page."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any

LIMIT = 300
"""Upper limit of such numbers; a larger model is built again after a drag."""
Keys = tuple[str | int, ...]


def with_drawn_parameters(data: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Keys]]:
    """The model with a parameter for each number of its drawing: lengths, angles and coordinates.

    Formulas and names of parameters stay as they are.

    Parameters
    ----------
    data : sections of a planar mechanism

    Returns
    -------
    data : with further parameters; the same if there are none, or too many
    places : name of such a parameter → keys of its number
    """
    places = dict(_numbers(data))
    if data.get("kind") == "structure" or not 0 < len(places) <= LIMIT:
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
    for name, body in _tables(data, "bodies"):
        for key, unit in (("length", "m"), ("angle", "rad")):
            if _is_number(body.get(key)):
                yield ("bodies", name, key), unit
        yield from _coordinates(("bodies", name, "position"), body.get("position"))
        for point, place in _tables(body, "points", lists=True):
            yield from _coordinates(("bodies", name, "points", point), place)
    ground = data.get("ground")
    if isinstance(ground, dict):
        for point, place in _tables(ground, "points", lists=True):
            yield from _coordinates(("ground", "points", point), place)
    for section in ("joints", "forces"):
        for name, element in _tables(data, section):
            ends = element.get("connect")
            for k, end in enumerate(ends if isinstance(ends, list) else ()):
                if isinstance(end, dict):
                    yield from _coordinates((section, name, "connect", k, "at"), end.get("at"))


def _tables(data: dict[str, Any], section: str, lists: bool = False) -> Iterator[tuple[str, Any]]:
    entries = data.get(section)
    for name, entry in entries.items() if isinstance(entries, dict) else ():
        if isinstance(entry, list if lists else dict):
            yield name, entry


def _coordinates(keys: Keys, place: Any) -> Iterator[tuple[Keys, str]]:
    if isinstance(place, list) and len(place) == 2:
        for i, value in enumerate(place):
            if _is_number(value):
                yield (*keys, i), "m"


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
