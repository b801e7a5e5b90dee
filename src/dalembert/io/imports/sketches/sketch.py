"""Import of a planar mechanism from a drawing."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import ModelError
from dalembert.io.imports.imported import Imported
from dalembert.io.imports.sketches import dxf, svg
from dalembert.io.imports.sketches.drawing import Circle, Drawing, Line, Slot
from dalembert.io.imports.sketches.guides import Guide, guides_and_blocks, place_guides
from dalembert.io.imports.sketches.labels import assign_labels
from dalembert.io.imports.sketches.links import Joining, Link
from dalembert.io.imports.sketches.mechanism import Mechanism
from dalembert.io.imports.sketches.misses import report_misses
from dalembert.io.imports.sketches.motors import add_drivers, motors_of
from dalembert.io.imports.sketches.pins import Pin, pins_of
from dalembert.io.imports.sketches.roles import Role, role_of
from dalembert.io.imports.sketches.sheet import Sheet, merged
from dalembert.text.wording import visible
from dalembert.units.measured import Measured, check_measured, measured

COINCIDENT = 1e-3
"""Default tolerance over the size of the drawing."""
SIZES = (1e-7, 1e5)
"""Limits of the size of a drawing [m]."""
MASS_PER_LENGTH, SPEED = 1.0, "60 rpm"
"""Default mass per length of lines [kg/m]; speed of a motor whose text states none."""
NO_LINE = "has no line that could move; draw bars as lines and pins as circles"
HEADING = """\
Planar mechanism from the drawing {name}: lines are bars, circles are pins.
Lengths and fixed points are parameters; positions and angles are those of the drawing."""
MASSES = "assumed: a drawing has no masses; all lines are slender bars with this mass per length"


def read_dxf(
    path: Path,
    *,
    unit: str | None = None,
    tolerance: float | str | None = None,
    mass_per_length: float | str = MASS_PER_LENGTH,
    speed: float | str = SPEED,
) -> Imported:
    """The planar mechanism in a DXF drawing.

    Parameters
    ----------
    path : of the file
    unit : of the drawing, such as ``"in"``, in place of ``$INSUNITS``
    tolerance : distance below which places coincide, in the unit of the drawing, or a text with
        its own; a thousandth of the size of the drawing by default
    mass_per_length : of all lines [kg/m]
    speed : of motors that state none [rad/s]

    Raises
    ------
    FileError, ModelError
        Names file, entity, value and a fix.
    """
    drawing = dxf.read_drawing(Path(path), _checked_unit(unit, path))
    return mechanism_of(drawing, tolerance, mass_per_length, speed)


def read_svg(
    path: Path,
    *,
    unit: str | None = None,
    tolerance: float | str | None = None,
    mass_per_length: float | str = MASS_PER_LENGTH,
    speed: float | str = SPEED,
) -> Imported:
    """The planar mechanism in an SVG drawing.

    Parameters
    ----------
    path : of the file
    unit : of its user coordinates, such as ``"mm"``, in place of that of ``width`` and ``viewBox``
    tolerance, mass_per_length, speed : as for ``read_dxf``

    Raises
    ------
    FileError, ModelError
        Names file, line, entity, value and a fix.
    """
    drawing = svg.read_drawing(Path(path), _checked_unit(unit, path))
    return mechanism_of(drawing, tolerance, mass_per_length, speed)


_NO_POINTS = np.zeros((0, 2))


def mechanism_of(
    drawing: Drawing,
    tolerance: float | str | None,
    mass_per_length: float | str,
    speed: float | str,
) -> Imported:
    """The mechanism in a drawing."""
    size = _size(drawing)
    limit = COINCIDENT * size
    if tolerance is not None:
        limit = _number(tolerance, "m", "tolerance", _metres(drawing.unit))
    density = _number(mass_per_length, "kg/m", "mass_per_length")
    pins = pins_of(drawing, limit)
    guides, blocks, lines = guides_and_blocks(drawing, pins, limit)
    joining = Joining(drawing, _without_frames(drawing, lines, pins, limit), pins, limit)
    links = [*joining.links(), *blocks]
    for link in links:
        link.is_ground = any(role_of(line.words) is Role.GROUND for line in link.lines)
    labelled = assign_labels(drawing, pins, links, guides, size)
    motors = motors_of(drawing, labelled, pins)
    place_guides(drawing, guides, blocks, links, pins, limit)
    _ground(drawing, pins, links, guides)
    report_misses(drawing, joining.lines, pins, links, guides, limit)
    moving = [link for link in links if not link.is_ground]
    if not moving:
        raise ModelError(NO_LINE, str(drawing.path))
    sheet = Sheet(drawing.unit, size)
    about = "mass per length of all bars"
    sheet.names.unique("rho", iter(()))
    sheet.parameters["rho"] = {"value": density, "unit": "kg/m", "description": about}
    mechanism = Mechanism(drawing, sheet, pins, links, guides)
    add_drivers(mechanism, motors, _number(speed, "rad/s", "speed"), size)
    comments = {"": HEADING.format(name=drawing.path.name), "parameters.rho": MASSES}
    return Imported(drawing.path, _document(mechanism), drawing.omissions, comments)


def _without_frames(
    drawing: Drawing, lines: list[Line], pins: list[Pin], tolerance: float
) -> list[Line]:
    """The lines without rectangles around all others, such as the background of a page."""
    remaining = list(lines)
    for line in [line for line in lines if line.closed and len(line.corners) == 4]:
        others = [other.corners for other in remaining if other is not line]
        points = np.concatenate([*others, *(pin.center[None] for pin in pins)] or [_NO_POINTS])
        low, high = line.corners.min(axis=0) + tolerance, line.corners.max(axis=0) - tolerance
        at_sides = (line.corners <= low) | (line.corners >= high)
        corners = {tuple(row) for row in (line.corners >= high).tolist()}
        is_upright = bool(at_sides.all()) and len(corners) == 4
        if others and is_upright and bool(((points > low) & (points < high)).all()):
            drawing.omit(
                line.place, "rectangle", "is a frame around the drawing, with no pin on it"
            )
            remaining = [other for other in remaining if other is not line]
    return remaining


def _document(mechanism: Mechanism) -> dict[str, Any]:
    drawing = mechanism.drawing
    traced = {"trace": mechanism.traced[:1]} if mechanism.traced else {}
    return merged(
        {"format": 1, "name": visible(drawing.path.stem), "gravity": [0.0, -9.81]},
        {"parameters": mechanism.sheet.parameters},
        {"ground": merged({"points": mechanism.ground_points})},
        {"bodies": {part.name: part.table for part in mechanism.parts}},
        {"joints": mechanism.joints, "drivers": mechanism.drivers},
        {"analysis": _analysis(mechanism), "report": traced},
    )


def _analysis(mechanism: Mechanism) -> dict[str, Any]:
    """Motion of drivers for a turn, or the free motion."""
    laws = [driver["law"].rpartition(" ")[2] for driver in mechanism.drivers.values()]
    if laws and len(laws) >= mechanism.freedom:
        driver = next(iter(mechanism.drivers.values()))
        turn = driver["type"] == "RotationalDriver"
        speed = laws[0].removesuffix("*t")
        return {
            "type": "Kinematics",
            "duration": f"2*pi/{speed}" if turn else 1.0,
            "outputs": 181,
        }
    return {"type": "Dynamics", "duration": 2.0, "outputs": 201}


def _ground(drawing: Drawing, pins: list[Pin], links: list[Link], guides: list[Guide]) -> None:
    """Final ground marks of pins and links."""
    fixed = [link for link in links if link.is_ground]
    for pin in {pin for link in fixed for pin in link.pins}:
        pin.is_ground = True
    slides = {pin for guide in guides for pin in guide.pins}
    if (
        not fixed
        and not any(pin.is_ground for pin in pins)
        and not any(_is_fixed(g) for g in guides)
    ):
        for pin in pins:
            on = [link for link in links if pin in link.pins]
            if len(on) == 1 and pin not in slides:
                pin.is_ground = True
                reason = (
                    "is taken as fixed, because one bar ends there and no pin is marked as fixed"
                )
                drawing.omit(pin.place, "circle", reason)
    for link in links:
        if not link.is_ground and len(link.pins) > 1 and all(pin.is_ground for pin in link.pins):
            link.is_ground = True
            drawing.omit(link.place, "line", "joins fixed pins alone, and is part of the ground")


def _is_fixed(guide: Guide) -> bool:
    return guide.owner is None


def _size(drawing: Drawing) -> float:
    """Diagonal of the box around lines and circles.

    Raises
    ------
    ModelError
        Nothing is drawn, or the size is absurd.
    """
    points = np.concatenate([np.zeros((0, 2)), *_points(drawing)])
    if not any(isinstance(entity, (Line, Slot)) for entity in drawing.entities):
        raise ModelError(NO_LINE, str(drawing.path))
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    metres = size * _metres(drawing.unit)
    if not SIZES[0] <= metres <= SIZES[1]:
        low, high = SIZES
        raise ModelError(
            f"the drawing is {size:.4g} {drawing.unit} large; sizes between {low:g} and {high:g} m "
            "are expected: correct its scale, or give its unit",
            str(drawing.path),
        )
    return size


def _points(drawing: Drawing) -> Iterator[np.ndarray]:
    for entity in drawing.entities:
        if isinstance(entity, Line):
            yield entity.corners
        elif isinstance(entity, Circle):
            yield entity.center[None]
        elif isinstance(entity, Slot):
            yield entity.ends


def _metres(unit: str) -> float:
    return float(measured(f"1 {unit}"))


def _checked_unit(unit: str | None, path: str | Path) -> str | None:
    if unit is not None:
        check_measured([measured(f"1 {unit}")], "m", f"{path}: unit")
    return unit


def _number(value: float | str, unit: str, name: str, scale: float = 1.0) -> float:
    """A positive number; texts have units and are divided by the scale."""
    number = measured(value)
    check_measured([number], unit, name)
    result = float(number) / (scale if isinstance(number, Measured) else 1.0)
    if not (math.isfinite(result) and result > 0):
        raise ModelError(f"is {value}; give a number above 0", name)
    return result
