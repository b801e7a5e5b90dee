"""Drivers of a drawn mechanism, from texts, layers and arrows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.errors import DalembertError
from dalembert.io.imports.sketches.drawing import Arrow, Drawing
from dalembert.io.imports.sketches.guides import Guide
from dalembert.io.imports.sketches.labels import NEAR, Motor
from dalembert.io.imports.sketches.mechanism import Mechanism
from dalembert.io.imports.sketches.names import series
from dalembert.io.imports.sketches.pins import Pin
from dalembert.units.amounts import Amount, check_unit
from dalembert.units.grammar import amount_of

SLOW = 10.0
"""Time in which a slider passes a length as large as the drawing, without a stated speed [s]."""


def motors_of(drawing: Drawing, labelled: list[Motor], pins: Sequence[Pin]) -> list[Motor]:
    """All marks of drivers, each once."""
    arrows = [entity for entity in drawing.entities if isinstance(entity, Arrow)]
    motors = [*labelled, *(Motor(pin.place, pin.center) for pin in pins if pin.is_motor)]
    centers = np.array([pin.center for pin in pins]).reshape(-1, 2)
    for arrow in arrows:
        away = np.linalg.norm(arrow.points[:, None] - centers, axis=2).min(axis=1, initial=np.inf)
        motors.append(Motor(arrow.place, arrow.points[int(away.argmin())]))
    return motors


def add_drivers(mechanism: Mechanism, motors: Sequence[Motor], speed: float, size: float) -> None:
    """Add drivers at the joints that are nearest to the marks.

    Parameters
    ----------
    speed : where the drawing states none [rad/s]
    size : of the drawing
    """
    driven: set[str] = set()
    for motor in motors:
        joint = _joint_of(mechanism, motor, size)
        if joint is None:
            mechanism.drawing.omit(motor.place, "motor", "is near no joint that it could drive")
        elif joint not in driven:
            driven.add(joint)
            _add(mechanism, motor, joint, speed, size)


def _joint_of(mechanism: Mechanism, motor: Motor, size: float) -> str | None:
    """The nearest joint, a fixed one if there is one nearby."""

    def rank(target: Pin | Guide) -> tuple[bool, float]:
        if isinstance(target, Guide):
            return False, target.away(motor.position)
        away = max(target.distance(motor.position) - target.radius, 0.0)
        return not target.is_ground, away

    near = [t for t in mechanism.joints_of if rank(t)[1] <= NEAR * size]
    return mechanism.joints_of[min(near, key=rank)][0] if near else None


def _add(mechanism: Mechanism, motor: Motor, joint: str, speed: float, size: float) -> None:
    turns = joint in mechanism.turning
    sheet, drawing = mechanism.sheet, mechanism.drawing
    unit, value = ("rad/s", speed) if turns else (f"{sheet.unit}/s", sheet.rounded(size / SLOW))
    stated = _stated_speed(drawing, motor, "rad/s" if turns else "m/s")
    if stated is not None:
        unit, value = stated
    elif turns:
        unit, value = "rpm", round(speed * 30 / math.pi, 9)
    parameter = sheet.declare("speed", value, unit, f"speed of the motor at {joint}")
    name = mechanism.names.unique("motor", series("motor"))
    if turns:
        part = mechanism.turning[joint]
        first = mechanism.joints[joint]["connect"][0].partition(".")[0]
        angles = {p.name: p.angle for p in mechanism.parts}
        start = sheet.angle(part.angle - angles.get(first, 0.0))
    else:
        start = sheet.text(mechanism.sliding[joint])
    mechanism.drivers[name] = {
        "type": "RotationalDriver" if turns else "TranslationalDriver",
        "joint": joint,
        "law": sheet.sum(("", start), ("", f"{parameter}*t")),
    }


def _stated_speed(drawing: Drawing, motor: Motor, expected: str) -> tuple[str, float] | None:
    """Unit and value of the speed in a label."""
    if not motor.speed:
        return None
    try:
        amount: Any = amount_of(motor.speed)
        if not isinstance(amount, Amount):
            raise DalembertError("it has no unit")
        check_unit(amount.si, expected, "speed", motor.speed)
    except DalembertError as error:
        reason = f"is no speed in {expected} ({error}); the default is used"
        drawing.omit(motor.place, f"text {motor.speed[:60]!r}", reason)
        return None
    number, _, unit = motor.speed.partition(" ")
    try:
        return unit.strip(), float(number)
    except ValueError:
        return expected, float(amount)
