"""Bodies of links: bars, plates over their pins, and sliding blocks."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.io.imports.sketches.guides import Block
from dalembert.io.imports.sketches.links import Link
from dalembert.io.imports.sketches.pins import Pin
from dalembert.io.imports.sketches.sheet import Sheet


@dataclass(eq=False)
class Part:
    """A body of the model file.

    Attributes
    ----------
    link : its lines
    name : of the body
    angle : of its x axis in the drawing [rad]
    base : (2,) place of its reference point in the drawing
    shift : formulas of the coordinates of the reference point in the body frame
    table : of the model file
    references : pin → point of the body, such as ``"crank.end"``
    """

    link: Link
    name: str
    angle: float
    base: np.ndarray
    shift: tuple[str | float, str | float]
    table: dict[str, Any]
    references: dict[Pin, str] = field(default_factory=dict)

    def local(self, point: np.ndarray) -> np.ndarray:
        """(2,) coordinates of a point from the reference point, in body axes."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        return np.array([[c, s], [-s, c]]) @ (point - self.base)

    def add_point(self, name: str, entries: tuple[str | float, str | float], sheet: Sheet) -> str:
        """Add a point by coordinates from the reference point; returns its reference."""
        points = self.table.setdefault("points", {})
        points[name] = [
            sheet.sum(("", entry), ("-", shift))
            for entry, shift in zip(entries, self.shift, strict=True)
        ]
        return f"{self.name}.{name}"

    def add_place(self, name: str, point: np.ndarray, sheet: Sheet) -> str:
        """Add a point of the drawing with plain numbers; returns its reference."""
        x, y = self.local(point)
        return self.add_point(name, (sheet.text(x), sheet.text(y)), sheet)


def make_part(link: Link, name: str, pin_names: Mapping[Pin, str], sheet: Sheet) -> Part:
    """The body of a link."""
    make: Callable[..., Part] = _plate
    if isinstance(link, Block):
        make = _block
    elif link.is_bar:
        make = _bar
    return make(link, name, pin_names, sheet)


def _bar(link: Link, name: str, pin_names: Mapping[Pin, str], sheet: Sheet) -> Part:
    start, end = link.segments[0]
    at = {tuple(pin.center): pin for pin in link.corners}
    first, last = at.get(tuple(start)), at.get(tuple(end))
    if (last is not None and last.is_ground) and not (first is not None and first.is_ground):
        start, end, first, last = end, start, last, first
    along = end - start
    length = sheet.length(name, float(np.linalg.norm(along)), f"length of {name}")
    angle = math.atan2(along[1], along[0])
    table = {
        "type": "Bar",
        "length": length,
        "mass": f"rho*{length}",
        "angle": sheet.angle(angle),
    }
    part = Part(link, name, angle, start, (f"{length}/2", 0.0), table)
    for pin, point in ((first, "start"), (last, "end")):
        if pin is not None:
            part.references[pin] = f"{name}.{point}"
    for pin in link.pins:
        if pin not in part.references:
            x, y = part.local(pin.center)
            about = f"distance of {pin_names[pin]} from the start of {name}"
            entry = sheet.length(f"{name}_{pin_names[pin]}", x, about)
            part.references[pin] = part.add_point(pin_names[pin], (entry, sheet.text(y)), sheet)
    return part


def _plate(link: Link, name: str, pin_names: Mapping[Pin, str], sheet: Sheet) -> Part:
    pins = sorted(link.pins, key=lambda pin: not pin.is_ground)
    total, center, second = link.moments()
    base = pins[0].center if pins else center
    along = pins[1].center - base if len(pins) > 1 else np.array([1.0, 0.0])
    angle = math.atan2(along[1], along[0])
    table = {"type": "Body", **_inertia(total, second, sheet), "angle": sheet.angle(angle)}
    part = Part(link, name, angle, base, (0.0, 0.0), table)
    if pins:
        at = "at" if len(pins) == 1 else f"from {pin_names[pins[0]]} towards {pin_names[pins[1]]}"
        x, y = part.local(center)
        part.shift = (
            sheet.length(f"{name}_center_x", x, f"mass centre of {name}, {at}"),
            sheet.length(f"{name}_center_y", y, f"mass centre of {name}, to the left"),
        )
    for k, pin in enumerate(pins):
        pin_name = pin_names[pin]
        x, y = part.local(pin.center)
        entries: tuple[str | float, str | float] = (0.0, 0.0)
        if k == 1:
            about = f"distance of {pin_name} from {pin_names[pins[0]]}"
            entries = (sheet.length(f"{name}_{pin_name}", x, about), 0.0)
        elif k > 1:
            entries = (
                sheet.length(f"{name}_{pin_name}_x", x, f"{pin_name} in {name}, {at}"),
                sheet.length(f"{name}_{pin_name}_y", y, f"{pin_name} in {name}, to the left"),
            )
        part.references[pin] = part.add_point(pin_name, entries, sheet)
    return part


def _block(link: Block, name: str, pin_names: Mapping[Pin, str], sheet: Sheet) -> Part:
    total, _, second = link.moments()
    angle = math.atan2(link.sides[0, 1], link.sides[0, 0])
    table = {"type": "Body", **_inertia(total, second, sheet), "angle": sheet.angle(angle)}
    part = Part(link, name, angle, link.middle, (0.0, 0.0), table)
    for pin in link.pins:
        is_middle = sheet.rounded(pin.distance(link.middle)) == 0
        part.references[pin] = (
            name if is_middle else part.add_place(pin_names[pin], pin.center, sheet)
        )
    return part


def _inertia(total: float, second: float, sheet: Sheet) -> dict[str, str]:
    """Mass and moment of inertia of slender bars."""
    digits = f"{second:.9g}"
    return {"mass": f"rho*{sheet.text(total)}", "inertia": f"rho*{digits} {sheet.unit}^3"}
