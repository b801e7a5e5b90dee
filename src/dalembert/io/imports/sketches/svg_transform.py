"""Coordinates of SVG files: units of the page, lengths and transformations."""

from __future__ import annotations

import math
import re

import numpy as np

from dalembert.budget import LARGEST
from dalembert.io.imports.xml.element import XmlElement

MILLIMETRES = {
    "": 25.4 / 96,
    "px": 25.4 / 96,
    "mm": 1.0,
    "cm": 10.0,
    "in": 25.4,
    "pt": 25.4 / 72,
    "pc": 25.4 / 6,
    "q": 0.25,
}
"""Unit of a length in SVG → millimetres."""
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_LENGTH = re.compile(rf"\s*({NUMBER})\s*([A-Za-z%]*)\s*")
_TRANSFORM = re.compile(r"\s*,?\s*(\w+)\s*\(([^()]*)\)")


def page(root: XmlElement, unit: str | None) -> tuple[np.ndarray, str]:
    """(3, 3) matrix from user coordinates to the unit of the drawing, y upwards; the unit.

    Parameters
    ----------
    unit : of user coordinates, in place of that of ``width`` and ``viewBox``
    """
    sizes = [_length(root, name) for name in ("width", "height")]
    box = root.attributes.get("viewBox")
    x, y, width, height = 0.0, 0.0, *(value or 0.0 for value, _ in sizes)
    scale = MILLIMETRES[""]
    if box is not None:
        x, y, width, height = _box(root, box)
        ratios = [
            value * MILLIMETRES[units] / extent
            for (value, units), extent in zip(sizes, (width, height), strict=True)
            if value and extent
        ]
        scale = min(ratios, default=scale)
    stated = next((units for value, units in sizes if value), "")
    name = stated if stated in ("cm", "in") else "mm"
    scale = scale / MILLIMETRES[name] if unit is None else 1.0
    matrix = np.array([[scale, 0, -x * scale], [0, -scale, (y + height) * scale], [0, 0, 1.0]])
    return matrix, unit or name


def has_size(root: XmlElement) -> bool:
    """Whether the page states its width or height in a unit of length, or in pixels."""
    return any(_length(root, name)[0] for name in ("width", "height"))


def viewport(element: XmlElement) -> np.ndarray:
    """(3, 3) matrix from coordinates inside a nested ``<svg>`` or a ``<symbol>`` to those outside.

    Both axes have the smaller scale, and the contents are centred (``xMidYMid meet``).

    Raises
    ------
    ModelError
        An invalid ``viewBox``, or another ``preserveAspectRatio``.
    """
    x, y = lengths(element, "x", "y")
    box = element.attributes.get("viewBox")
    if box is None:
        return np.array([[1.0, 0, x], [0, 1.0, y], [0, 0, 1.0]])
    fit = element.attributes.get("preserveAspectRatio", "xMidYMid meet").split()
    if fit not in (["xMidYMid"], ["xMidYMid", "meet"]):
        raise element.error(
            f"preserveAspectRatio is {' '.join(fit)[:60]!r}; only 'xMidYMid meet' is read: ungroup "
            "the nested drawing"
        )
    left, top, *extents = _box(element, box)
    sizes = [_length(element, name) for name in ("width", "height")]
    outer = [
        value * MILLIMETRES[units] / MILLIMETRES[""] if value else extent
        for (value, units), extent in zip(sizes, extents, strict=True)
    ]
    scale = min(size / extent for size, extent in zip(outer, extents, strict=True))
    gaps = [(size - scale * extent) / 2 for size, extent in zip(outer, extents, strict=True)]
    shift = x + gaps[0] - left * scale, y + gaps[1] - top * scale
    return np.array([[scale, 0, shift[0]], [0, scale, shift[1]], [0, 0, 1.0]])


def _box(root: XmlElement, text: str) -> list[float]:
    root.attributes["viewBox"] = text.replace(",", " ")
    box = root.numbers("viewBox", 4)
    if not (box[2] > 0 and box[3] > 0):
        raise root.error(f"viewBox is {text!r}, expected a width and a height above 0")
    return box


def _length(root: XmlElement, name: str) -> tuple[float | None, str]:
    """A length of the page with its unit; None without one, or relative to a window."""
    match = _LENGTH.fullmatch(root.attributes.get(name, ""))
    if match is None or match[2].lower() not in MILLIMETRES or not math.isfinite(float(match[1])):
        return None, ""
    return float(match[1]), match[2].lower()


def lengths(element: XmlElement, *names: str) -> list[float]:
    """Attributes in user coordinates; 0 for missing ones.

    Raises
    ------
    ModelError
        Not a number, or relative to a window or a font.
    """
    return [_user_length(element, name) for name in names]


def _user_length(element: XmlElement, name: str) -> float:
    text = (element.attributes.get(name, "0").replace(",", " ").split() or ["0"])[0]
    match = _LENGTH.fullmatch(text)
    unit = match[2].lower() if match else ""
    if match is None or unit not in MILLIMETRES:
        raise element.error(
            f"{name} is {text[:60]!r}, expected a number with one of the units "
            f"{', '.join(u for u in MILLIMETRES if u)}, or without"
        )
    number = float(match[1])
    if not abs(number) < LARGEST:
        raise element.error(f"{name} is {text[:60]!r}, which is no usable number")
    return number * MILLIMETRES[unit] / MILLIMETRES[""] if unit else number


def parse_transform(text: str, element: XmlElement) -> np.ndarray:
    """(3, 3) matrix of a list such as ``translate(2 3) rotate(30)``.

    Raises
    ------
    ModelError
        Unknown transformation, or a wrong number of arguments.
    """
    matrix, position = np.eye(3), 0
    while text[position:].strip():
        match = _TRANSFORM.match(text, position)
        if match is None:
            raise _error(element, text)
        words = match[2].replace(",", " ").split()
        try:
            values = [float(word) for word in words]
            with np.errstate(all="ignore"):
                matrix = matrix @ _matrix(match[1], values)
        except (ValueError, KeyError, OverflowError):
            raise _error(element, text) from None
        position = match.end()
    if not np.isfinite(matrix).all():
        raise _error(element, text)
    return matrix


def _error(element: XmlElement, text: str) -> Exception:
    known = "matrix, translate, scale, rotate, skewX, skewY"
    return element.error(f"transform is {text[:80]!r}, expected a list of {known} with numbers")


def _matrix(kind: str, values: list[float]) -> np.ndarray:
    if kind == "matrix" and len(values) == 6:
        a, b, c, d, e, f = values
    elif kind == "translate" and len(values) in (1, 2):
        a, b, c, d, e, f = 1, 0, 0, 1, values[0], values[1] if len(values) == 2 else 0
    elif kind == "scale" and len(values) in (1, 2):
        a, b, c, d, e, f = values[0], 0, 0, values[-1], 0, 0
    elif kind == "rotate" and len(values) in (1, 3):
        cos, sin = math.cos(math.radians(values[0])), math.sin(math.radians(values[0]))
        x, y = values[1:] or (0.0, 0.0)
        a, b, c, d = cos, sin, -sin, cos
        e, f = x - cos * x + sin * y, y - sin * x - cos * y
    elif kind in ("skewX", "skewY") and len(values) == 1:
        slope = math.tan(math.radians(values[0]))
        a, b, c, d, e, f = (
            1,
            slope if kind == "skewY" else 0,
            slope if kind == "skewX" else 0,
            1,
            0,
            0,
        )
    else:
        raise KeyError(kind)
    return np.array([[a, c, e], [b, d, f], [0, 0, 1.0]])
