"""Candidates of a synthesis as entries of a model file: four-bars, slider-cranks, six-bars."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from dalembert.design.synthesis.four_bar import FourBar
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.slider_crank import SliderCrank
from dalembert.elements.planar.drivers import RotationalDriver
from dalembert.elements.planar.revolute import Revolute


def linkage_operations(linkage: Linkage, start: float) -> Iterator[dict[str, Any]]:
    """Operations that add a linkage to a model file, as ``drawing_edits`` carries them out.

    Parameters
    ----------
    linkage : four-bar or slider-crank
    start : angle of its crank [rad]
    """
    q = linkage.numbers
    phi, output = (float(value) for value in linkage.loop(q, linkage.branch, np.array(start)))

    def add(section: str, name: str, **fields: Any) -> dict[str, Any]:
        return _added(section, name, fields)

    def bar(name: str, length: float, angle: float, **fields: Any) -> dict[str, Any]:
        sizes = {"length": _short(length), "mass": _short(length), "angle": _short(angle)}
        return add("bodies", name, type="Bar", **sizes, **fields)

    def revolute(name: str, *ends: Any) -> dict[str, Any]:
        return add("joints", name, type="Revolute", connect=list(ends))

    yield bar("crank", q["crank"], start)
    point = [_short(q["u"] - q["coupler"] / 2), _short(q["v"])]
    yield bar("coupler", q["coupler"], phi, points={"P": point})
    if isinstance(linkage, FourBar):
        pivot = complex(q["x"], q["y"]) + q["ground"] * np.exp(1j * q["angle"])
        yield bar("follower", q["follower"], output)
        yield revolute("O", _ground(q["x"], q["y"]), "$crank.start")
        yield revolute("A", "$crank.end", "$coupler.start")
        yield revolute("B", "$coupler.end", "$follower.end")
        yield revolute("C", _ground(pivot.real, pivot.imag), "$follower.start")
    elif isinstance(linkage, SliderCrank):
        direction = np.exp(1j * q["angle"])
        place = complex(q["x"], q["y"]) + complex(output, q["offset"]) * direction
        rail = complex(q["x"], q["y"]) + 1j * q["offset"] * direction
        at = [_short(place.real), _short(place.imag)]
        angle = _short(q["angle"])
        yield add("bodies", "slider", mass=1.0, inertia=1.0, position=at, angle=angle)
        yield revolute("O", _ground(q["x"], q["y"]), "$crank.start")
        yield revolute("A", "$crank.end", "$coupler.start")
        yield revolute("B", "$coupler.end", "$slider")
        axis = [_short(direction.real), _short(direction.imag)]
        ends = [_ground(rail.real, rail.imag), "$slider"]
        yield add("joints", "rail", type="Prismatic", connect=ends, axis=axis, angle=angle)
    law = f"{_short(start)} + 2*pi*t"
    motor = {"connect": ["ground", "$crank"], "law": law}
    yield add("drivers", "motor", type="RotationalDriver", **motor)


def mechanism_operations(motion: Any) -> list[dict[str, Any]] | None:
    """Operations that add a mechanism of bodies, revolute joints and one motor to a model file.

    Parameters
    ----------
    motion : Motion of the mechanism; its first position is the drawn one

    Returns
    -------
    None if the mechanism has other elements
    """
    model = motion.model
    operations: list[dict[str, Any]] = []
    for body in model.bodies:
        x, y, angle = (float(motion.values(f"{body.name}.{c}")[0]) for c in ("x", "y", "angle"))
        turn = np.exp(-1j * angle)
        points = {}
        for name, point in body.points.items():
            local = (_at_start(motion, point) - complex(x, y)) * turn
            points[name] = [_short(local.real), _short(local.imag)]
        size = _short(max((abs(complex(*place)) for place in points.values()), default=1.0))
        fields: dict[str, Any] = {"mass": size, "inertia": _short(size**3 / 3)}
        fields |= {"position": [_short(x), _short(y)], "angle": _short(angle), "points": points}
        operations.append(_added("bodies", body.name, fields))
    for element in model.closure.description.constraints:
        if isinstance(element, Revolute):
            ends = [element.point_i, element.point_j]
            places = [_reference(motion, end, ends) for end in ends]
            fields = {"type": "Revolute", "connect": places}
            operations.append(_added("joints", element.name, fields))
        elif isinstance(element, RotationalDriver) and element.body_i.name == "ground":
            driven = element.body_j.name
            angles = motion.values(f"{driven}.angle")
            sign = "-" if angles[1] < angles[0] else ""
            law = f"{_short(float(angles[0]))} + {sign}2*pi*t".replace("+ -", "- ")
            motor = {"type": "RotationalDriver", "connect": ["ground", f"${driven}"], "law": law}
            operations.append(_added("drivers", "motor", motor))
        else:
            return None
    return operations


def _added(section: str, name: str, fields: dict[str, Any]) -> dict[str, Any]:
    entry = {"op": "add", "section": section, "base": name, "as": f"${name}"}
    return entry | {"fields": fields}


def _at_start(motion: Any, point: Any) -> complex:
    return complex(*(float(motion.values(f"{point.name}.{axis}")[0]) for axis in "xy"))


def _reference(motion: Any, end: Any, ends: list[Any]) -> Any:
    """End of a joint; a point of the ground is where that of the other body is."""
    if end.body.name != "ground":
        return f"${end.name}"
    (other,) = (point for point in ends if point is not end)
    place = _at_start(motion, other)
    return _ground(place.real, place.imag)


def _ground(x: float, y: float) -> dict[str, Any]:
    return {"body": "ground", "at": [_short(x), _short(y)]}


def _short(value: float) -> float:
    return float(f"{value:.12g}")
