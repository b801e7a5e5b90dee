"""Pins of a drawing: circles, with their ground marks."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dalembert.io.imports.sketches.drawing import Circle, Drawing
from dalembert.io.imports.sketches.roles import Role, role_of

OUTLINE = 3.0
"""Ratio of radii from which a circle around a pin is an outline of a part, not a mark."""
ALIKE = 1e-6
"""Relative difference of radii of a circle that is drawn twice."""


@dataclass(eq=False)
class Pin:
    """A place where links are joined.

    Attributes
    ----------
    center : (2,) in the unit of the drawing
    radius : of its largest circle
    place : file and entity
    is_ground : whether it is fixed
    name : empty for none
    """

    center: np.ndarray
    radius: float
    place: str
    is_ground: bool = False
    is_motor: bool = False
    name: str = ""
    radii: list[float] = field(default_factory=list)

    def distance(self, point: np.ndarray) -> float:
        return float(np.linalg.norm(self.center - point))


def pins_of(drawing: Drawing, tolerance: float) -> list[Pin]:
    """Pins at circles; concentric circles, filled ones and the layer ``ground`` are fixed."""
    pins: list[Pin] = []
    for circle in sorted(drawing.circles(), key=lambda circle: circle.radius):
        near = [pin for pin in pins if pin.distance(circle.center) <= max(tolerance, circle.radius)]
        concentric = [pin for pin in near if pin.distance(circle.center) <= tolerance]
        if any(circle.radius > OUTLINE * max(pin.radius, tolerance) for pin in near):
            reason = (
                "is an outline around other pins and makes no body; draw lines between its pins"
            )
            drawing.omit(circle.place, "circle", reason)
        elif concentric:
            _merge(drawing, concentric[0], circle)
        else:
            _report_overlap(drawing, circle, near)
            radius = circle.radius or tolerance
            pin = Pin(circle.center, radius, circle.place, radii=[circle.radius])
            pin.name = circle.name
            pins.append(pin)
            _mark(pin, circle)
    return pins


def _merge(drawing: Drawing, pin: Pin, circle: Circle) -> None:
    """Add a concentric circle to a pin, which is fixed if the radii differ."""
    is_repeated = any(abs(circle.radius - r) <= ALIKE * circle.radius for r in pin.radii)
    if is_repeated and not circle.filled and role_of(circle.words) is Role.PART:
        drawing.omit(circle.place, "circle", f"is drawn twice, here and by {_short(pin.place)}")
    elif not is_repeated and pin.radii[0] > 0:
        pin.is_ground = True
    pin.radius = max(pin.radius, circle.radius)
    pin.radii.append(circle.radius)
    pin.name = pin.name or circle.name
    _mark(pin, circle)


def _mark(pin: Pin, circle: Circle) -> None:
    role = role_of((*circle.words, circle.name))
    pin.is_ground = pin.is_ground or circle.filled or role is Role.GROUND
    pin.is_motor = pin.is_motor or role is Role.MOTOR


def _report_overlap(drawing: Drawing, circle: Circle, near: list[Pin]) -> None:
    for pin in near:
        drawing.omit(
            circle.place,
            f"circle, {pin.distance(circle.center):.4g} {drawing.unit} beside {_short(pin.place)}",
            "overlaps it, and both are pins; move one, or raise the tolerance to merge them",
        )


def _short(place: str) -> str:
    """A place without its file."""
    return place.partition(": ")[2] or place
