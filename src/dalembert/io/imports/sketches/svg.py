"""Drawings in SVG files.

Nothing outside the file is read: images, links, fonts and style sheets of other files are not.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import FileError, ModelError
from dalembert.io.imports.sketches.drawing import VISITED, Circle, Drawing, Label
from dalembert.io.imports.sketches.names import is_automatic
from dalembert.io.imports.sketches.roles import Role, group_of, role_of
from dalembert.io.imports.sketches.svg_paths import Shape, add_shape, shapes_of
from dalembert.io.imports.sketches.svg_style import Style, read_style_sheets
from dalembert.io.imports.sketches.svg_transform import (
    has_size,
    lengths,
    page,
    parse_transform,
    viewport,
)
from dalembert.io.imports.xml.element import XmlElement
from dalembert.io.imports.xml.parsing import read_xml

DEFINITIONS = (
    "defs symbol clipPath mask marker pattern linearGradient radialGradient filter style title "
    "desc metadata namedview"
).split()
"""Elements that draw nothing by themselves."""
GROUPS = ("g", "a", "svg", "symbol", "switch", "use")
CLONES = 8
"""Upper limit of the depth of clones in clones."""
LINES = ("line", "polyline", "polygon", "rect", "path")
ROUND = 1e-3
"""Relative difference of the radii of an ellipse that is a circle."""
ABOVE, WIDE = 0.35, 0.6
"""Middle of a text above its line, and usual width of a character, over the size of its font."""
ANCHORS = {"start": 0.5, "middle": 0.0, "end": -0.5}


def read_drawing(path: Path, unit: str | None) -> Drawing:
    """Lines, circles and texts of an SVG file, with y upwards.

    Parameters
    ----------
    path : of the file
    unit : of user coordinates, in place of that of ``width`` and ``viewBox``

    Raises
    ------
    FileError, ModelError
        Not an SVG file; a number is not finite; too many entities.
    """
    root = read_xml(path)
    if _tag(root) != "svg":
        raise FileError(f"{path}: line {root.line}: begins with {root.label}, not with <svg>")
    matrix, stated = page(root, unit)
    drawing = Drawing(path, stated)
    if unit is None and not has_size(root):
        reason = 'has no width in mm, cm, in or pt; 96 user units are taken as an inch, see "unit"'
        drawing.omit(f"{path}: line {root.line}: <svg>", "unit of length", reason)
    return _Reader(drawing, root).read(_Context(matrix))


@dataclass(frozen=True)
class _Context:
    """State inherited from outer elements."""

    matrix: np.ndarray
    words: tuple[str, ...] = ()
    group: str = ""
    style: Style = field(default_factory=Style)
    clones: int = 0
    is_cloned: bool = False


class _Reader:
    """Conversion of elements.

    Parameters
    ----------
    drawing : gets the entities
    root : ``<svg>``
    """

    def __init__(self, drawing: Drawing, root: XmlElement):
        self.drawing, self.root = drawing, root
        self.rules = read_style_sheets(root)
        self.lines = sum(_tag(element) in LINES for element in _all(root))
        self.named = {e.attributes["id"]: e for e in _all(root) if "id" in e.attributes}

    def read(self, context: _Context) -> Drawing:
        pending = [(child, context) for child in reversed(self.root.children)]
        visited = 0
        while pending:
            element, outer = pending.pop()
            tag = _tag(element)
            is_clone = tag == "symbol" and outer.is_cloned
            if (tag in DEFINITIONS and not is_clone) or _is_foreign(element):
                continue
            visited += 1
            if visited > VISITED:
                raise ModelError(
                    f"the drawing has more than {VISITED} elements; save the mechanism alone",
                    str(self.drawing.path),
                )
            style = outer.style.of(element, self.rules)
            place = self._place(element)
            if style.is_hidden:
                self.drawing.omit(place, f"<{tag}>", "is hidden")
                continue
            text = element.attributes.get("transform", "")
            matrix = outer.matrix @ parse_transform(text, element)
            context = replace(outer, matrix=matrix, style=style, is_cloned=False)
            if tag in GROUPS:
                context = self._grouped(element, context)
                pending += [(child, inner) for child, inner in self._inside(element, tag, context)]
            else:
                self._convert(element, tag, place, context)
        return self.drawing

    def _inside(
        self, element: XmlElement, tag: str, context: _Context
    ) -> list[tuple[XmlElement, _Context]]:
        """Drawn contents of a group or clone, the last first, in their coordinates."""
        children = element.children
        if tag == "use":
            attributes = element.attributes
            target = attributes.get("href") or attributes.get("xlink:href", "")
            original = self.named.get(target.removeprefix("#")) if target[:1] == "#" else None
            if original is None or context.clones >= CLONES:
                reason = f"refers to {target[:60]!r}, which is no element of this drawing"
                if original is not None:
                    reason = "is a clone of clones, nested too deeply; unlink clones"
                self.drawing.omit(self._place(element), "<use>", reason)
                return []
            matrix = context.matrix @ _translation(*lengths(element, "x", "y"))
            inner = replace(context, matrix=matrix, clones=context.clones + 1, is_cloned=True)
            return [(original, inner)]
        if tag in ("svg", "symbol"):
            matrix = context.matrix @ viewport(element)
            context = replace(context, matrix=matrix)
        if tag == "switch":
            readable = [c for c in children if _tag(c) not in ("foreignObject", *DEFINITIONS)]
            for other in (c for c in children if c not in readable[:1]):
                reason = "is one of the alternatives of a <switch>; the first drawn one is read"
                self.drawing.omit(self._place(other), f"<{_tag(other)}>", reason)
            children = readable[:1]
        return [(child, context) for child in reversed(children)]

    def _grouped(self, element: XmlElement, context: _Context) -> _Context:
        """The context inside of a group."""
        classes = element.attributes.get("class", "").split()
        label = _label(element)
        words = (*context.words, *classes, *([label] if label else []))
        named = [label] if label and not is_automatic(label) else []
        group = group_of([*named]) or context.group
        drawn = [child for child in element.children if _tag(child) not in DEFINITIONS]
        only_lines = all(_tag(child) in LINES for child in drawn) and 1 < len(drawn) < self.lines
        if label and not named and only_lines and not _is_layer(element):
            group = f"link:{element.line}"
        return replace(context, words=words, group=group)

    def _convert(self, element: XmlElement, tag: str, place: str, context: _Context) -> None:
        label = _label(element)
        classes = element.attributes.get("class", "").split()
        words = (*context.words, *classes, *([label] if label else []))
        name = "" if is_automatic(label) else label
        data: dict[str, Any] = {"place": place, "words": words, "name": name}
        data["group"] = context.group
        role = role_of(words)
        if role is Role.IGNORED:
            reason = "its layer or group is no part of the mechanism, by its name"
            self.drawing.omit(place, f"<{tag}>", reason)
        elif tag in ("circle", "ellipse"):
            self._circle(element, tag, data, context)
        elif tag in LINES:
            for shape in shapes_of(element, tag):
                moved = Shape(
                    _moved(context.matrix, shape.corners), shape.closed, shape.bulges, shape.bent
                )
                add_shape(self.drawing, moved, context.style.is_filled, role, data, f"<{tag}>")
        elif tag == "text":
            self._text(element, data, context)
        else:
            reason = "is not read; draw lines, circles and texts (unlink clones)"
            self.drawing.omit(place, f"<{tag}>", reason)

    def _circle(
        self, element: XmlElement, tag: str, data: dict[str, Any], context: _Context
    ) -> None:
        radii = ("r", "r") if tag == "circle" else ("rx", "ry")
        cx, cy, rx, ry = lengths(element, "cx", "cy", *radii)
        linear = context.matrix[:2, :2] * [rx, ry]
        widths = np.linalg.svd(linear, compute_uv=False)
        if widths[0] - widths[1] > ROUND * widths[0]:
            reason = "is an ellipse; draw pins as circles"
            self.drawing.omit(data["place"], f"<{tag}>", reason)
            return
        center = _moved(context.matrix, np.array([[cx, cy]]))[0]
        filled = context.style.is_filled
        self.drawing.add(Circle(**data, center=center, radius=float(widths.mean()), filled=filled))

    def _text(self, element: XmlElement, data: dict[str, Any], context: _Context) -> None:
        """A label for the text, and one for each part of it with its own position."""
        parts = [element, *(child for child in _all(element) if _tag(child) == "tspan")]
        placed = [part for part in parts if "x" in part.attributes] or [element]
        start = placed[0]
        for part in placed:
            inner = [p for p in _all(part) if p is part or p not in placed]
            text = " ".join(" ".join(p.content for p in inner).split())
            if not text:
                continue
            x = lengths(part, "x")[0]
            y = lengths(part if "y" in part.attributes else start, "y")[0]
            style = context.style if part is element else context.style.of(part, self.rules)
            size = style.font_size
            across = ANCHORS.get(style.anchor, 0.5) * WIDE * size * len(text)
            middle = _moved(context.matrix, np.array([[x + across, y - ABOVE * size]]))[0]
            self.drawing.add(Label(**data, position=middle, text=text))

    def _place(self, element: XmlElement) -> str:
        label = _label(element)
        shown = f' id="{label[:40]}"' if label else ""
        return f"{self.drawing.path}: line {element.line}: <{_tag(element)}{shown}>"


def _is_foreign(element: XmlElement) -> bool:
    """Whether an element belongs to a drawing program, such as ``sodipodi:namedview``."""
    return ":" in element.tag and not element.tag.startswith("svg:")


def _translation(x: float, y: float) -> np.ndarray:
    return np.array([[1.0, 0, x], [0, 1.0, y], [0, 0, 1.0]])


def _tag(element: XmlElement) -> str:
    return element.tag.rpartition(":")[2]


def _label(element: XmlElement) -> str:
    """The name that a person sees in the drawing program, else the id."""
    attributes = element.attributes
    return attributes.get("inkscape:label") or attributes.get("id", "")


def _is_layer(element: XmlElement) -> bool:
    return element.attributes.get("inkscape:groupmode") == "layer"


def _all(root: XmlElement) -> Iterator[XmlElement]:
    """An element and all elements in it."""
    pending = [root]
    while pending:
        element = pending.pop()
        yield element
        pending.extend(reversed(element.children))


def _moved(matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    with np.errstate(all="ignore"):  # the drawing refuses numbers that are not finite
        return np.asarray(points @ matrix[:2, :2].T + matrix[:2, 2])
