"""Lines of SVG elements: paths, rectangles, polygons, and the slots and circles among them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.budget import LARGEST
from dalembert.io.imports.sketches.drawing import CURVES, Arrow, Circle, Drawing, Line
from dalembert.io.imports.sketches.outlines import outline
from dalembert.io.imports.sketches.roles import Role
from dalembert.io.imports.sketches.svg_transform import NUMBER, lengths
from dalembert.io.imports.xml.element import XmlElement

COUNTS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
"""Command of a path → count of its numbers."""
STRAIGHT = 1e-6
"""Deviation of a straight curve over its length."""
ROUND = 5e-3
"""Relative deviation of the corners of a circle that is drawn as curves."""
_TOKEN = re.compile(rf"([A-Za-z])|({NUMBER})|([\s,]+)")


@dataclass(frozen=True)
class Shape:
    """One line of an element.

    Attributes
    ----------
    corners : (n, 2)
    closed : whether the last corner is joined to the first
    bulges : (n,) of arcs from each corner to the next, 0 for straight pieces
    bent : whether pieces are curves of other kinds
    """

    corners: np.ndarray
    closed: bool
    bulges: np.ndarray
    bent: np.ndarray


def shapes_of(element: XmlElement, tag: str) -> Iterator[Shape]:
    """The lines of an element.

    Raises
    ------
    ModelError
        Wrong numbers; names the line and the element.
    """
    if tag == "path":
        yield from _path(element)
    elif tag == "rect":
        yield _rectangle(element)
    elif tag == "line":
        x1, y1, x2, y2 = lengths(element, "x1", "y1", "x2", "y2")
        yield _shape([(x1, y1), (x2, y2)], False)
    else:
        text = element.attributes.get("points", "")
        element.attributes["points"] = re.sub(r"(?<=[\d.])-", " -", text.replace(",", " "))
        numbers = element.numbers("points")
        if len(numbers) % 2:
            raise element.error(f"points has {len(numbers)} numbers, expected pairs")
        if numbers:
            yield _shape(list(zip(numbers[::2], numbers[1::2], strict=True)), tag == "polygon")


def _shape(corners: list, closed: bool, bulges: Any = None, bent: Any = None) -> Shape:
    n = len(corners)
    return Shape(
        np.array(corners, dtype=float).reshape(-1, 2),
        closed,
        np.array([0.0] * n if bulges is None else bulges, dtype=float),
        np.array([False] * n if bent is None else bent, dtype=bool),
    )


def _rectangle(element: XmlElement) -> Shape:
    x, y, width, height = lengths(element, "x", "y", "width", "height")
    names = [name for name in ("rx", "ry") if element.attributes.get(name, "auto") != "auto"]
    radius = min([*lengths(element, *names), min(width, height) / 2]) if names else 0.0
    if width > 0 and height > 0 and radius >= 0.999 * min(width, height) / 2:
        r = min(width, height) / 2
        if width >= height:
            corners = [
                (x + r, y),
                (x + width - r, y),
                (x + width - r, y + height),
                (x + r, y + height),
            ]
            return _shape(corners, True, [0, 1, 0, 1])
        corners = [(x, y + r), (x, y + height - r), (x + width, y + height - r), (x + width, y + r)]
        return _shape(corners, True, [0, 1, 0, 1])
    return _shape([(x, y), (x + width, y), (x + width, y + height), (x, y + height)], True)


def add_shape(
    drawing: Drawing, shape: Shape, filled: bool, role: Role, data: dict[str, Any], tag: str
) -> None:
    """Add a line, slot or circle to the drawing, or report a curve."""
    if role is Role.MOTOR:
        drawing.add(Arrow(**data, points=shape.corners))
        return
    if shape.closed and (circle := _circle(shape, data, filled)) is not None:
        drawing.add(circle)
        return
    converted = outline(shape.corners, shape.closed, shape.bulges, 0.0, data)
    curved = shape.bent | (shape.bulges != 0)
    pieces = len(shape.corners) if shape.closed else len(shape.corners) - 1
    if isinstance(converted, Line) and curved.any():
        if curved.sum() >= pieces:
            drawing.omit(data["place"], tag, CURVES)
            return
        reason = "its curves are replaced by straight lines between its corners"
        drawing.omit(data["place"], tag, reason)
    drawing.add(converted)


def _circle(shape: Shape, data: dict[str, Any], filled: bool) -> Circle | None:
    """The circle whose equally spaced corners are joined by curves."""
    corners = shape.corners
    curved = shape.bent | (shape.bulges != 0)
    if len(corners) > 2 and np.allclose(corners[0], corners[-1]):
        corners, curved = corners[:-1], curved[:-1]
    if len(corners) < 2 or not curved.all() or (len(corners) == 2 and shape.bent.any()):
        return None
    center = corners.mean(axis=0)
    radii = np.linalg.norm(corners - center, axis=1)
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    expected = 2 * radii.mean() * math.sin(math.pi / len(corners))
    is_round = np.ptp(radii) <= ROUND * radii.mean() and radii.mean() > 0
    if not is_round or (np.abs(sides - expected) > ROUND * expected).any():
        return None
    arcs = np.abs(shape.bulges[: len(corners)])
    if len(corners) == 2 and (np.abs(arcs - 1) > ROUND).any():
        return None
    return Circle(**data, center=center, radius=float(radii.mean()), filled=filled)


def _path(element: XmlElement) -> Iterator[Shape]:
    """Sub-paths of the attribute ``d``."""
    corners: list[np.ndarray] = []
    bulges: list[float] = []
    bent: list[bool] = []
    current = start = np.zeros(2)
    for command, numbers in _commands(element):
        kind, relative = command.upper(), command.islower()
        origin = current if relative else np.zeros(2)
        if kind in "MZ":
            if len(corners) > 1:
                yield _shape(corners, kind == "Z", [*bulges, 0.0], [*bent, False])
            corners, bulges, bent = [], [], []
            current = start = start if kind == "Z" else origin + numbers
            if kind == "M":
                corners = [current]
            continue
        corners = corners or [current]
        end, bulge, is_bent = _piece(kind, numbers, origin, current, relative)
        corners.append(end)
        bulges.append(bulge)
        bent.append(is_bent)
        current = end
    if len(corners) > 1:
        yield _shape(corners, False, [*bulges, 0.0], [*bent, False])


def _piece(
    kind: str, numbers: list[float], origin: np.ndarray, current: np.ndarray, relative: bool
) -> tuple[np.ndarray, float, bool]:
    """End, bulge and bend of a piece of a path."""
    if kind == "H":
        return np.array([origin[0] + numbers[0], current[1]]), 0.0, False
    if kind == "V":
        return np.array([current[0], origin[1] + numbers[0]]), 0.0, False
    end = origin + numbers[-2:]
    if kind == "A":
        return end, _bulge(current, end, numbers), False
    if kind in "CQ":
        controls = np.array(numbers[:-2]).reshape(-1, 2) + origin - current
        along = end - current
        size = float(np.linalg.norm(along))
        away = np.abs(along[0] * controls[:, 1] - along[1] * controls[:, 0]).max()
        return end, 0.0, bool(away > STRAIGHT * size**2 or size == 0)
    return end, 0.0, kind in "ST"


def _bulge(start: np.ndarray, end: np.ndarray, numbers: list[float]) -> float:
    """Tangent of a quarter of the angle of a circular arc."""
    radius, chord = abs(numbers[0]), float(np.linalg.norm(end - start))
    if radius == 0 or chord == 0 or abs(numbers[1]) == 0:
        return 0.0
    angle = 2 * math.asin(min(1.0, chord / (2 * radius)))
    angle = 2 * math.pi - angle if numbers[3] else angle
    return math.tan(angle / 4) * (1 if numbers[4] else -1)


def _commands(element: XmlElement) -> Iterator[tuple[str, list[float]]]:
    """Commands of a path with their numbers; repeated ones follow each other."""
    text = element.attributes.get("d", "")
    command, position = "", 0
    numbers: list[float] = []
    while position < len(text):
        if command.upper() == "A" and len(numbers) in (3, 4) and text[position] in "01":
            numbers.append(float(text[position]))  # flags need no separator
            position += 1
            continue
        match = _TOKEN.match(text, position)
        if match is None or (match[1] and match[1].upper() not in COUNTS):
            raise _path_error(element, text, position)
        position = match.end()
        if match[1]:
            if numbers or (not command and match[1].upper() != "M"):
                raise _path_error(element, text, position - 1)
            command = match[1]
            if command in "Zz":
                yield command, []
        elif match[2]:
            if not command or command in "Zz":
                raise _path_error(element, text, position - 1)
            numbers.append(float(match[2]))
            if not abs(numbers[-1]) < LARGEST:
                raise _path_error(element, text, position - 1)
            if len(numbers) == COUNTS[command.upper()]:
                yield command, numbers
                numbers = []
                command = {"M": "L", "m": "l"}.get(command, command)
    if numbers:
        raise _path_error(element, text, len(text))


def _path_error(element: XmlElement, text: str, position: int) -> Exception:
    near = text[max(position - 20, 0) : position + 20]
    return element.error(f"the path is wrong at character {position + 1}: {near!r}; correct d")
