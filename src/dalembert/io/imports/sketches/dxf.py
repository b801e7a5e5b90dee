"""Drawings in DXF files, read with ezdxf."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import FileError, ModelError
from dalembert.files import readable
from dalembert.io.imports.sketches.drawing import (
    CURVES,
    VISITED,
    Arrow,
    Circle,
    Drawing,
    Label,
    Line,
)
from dalembert.io.imports.sketches.outlines import SAME, Arc, add_circles_of_arcs, outline
from dalembert.io.imports.sketches.roles import Role, group_of, role_of
from dalembert.packages import optional_package

WEIGHT = 200
"""Memory per byte of a file while it is read [bytes]."""
UNITS = {
    1: "in",
    2: "ft",
    4: "mm",
    5: "cm",
    6: "m",
    7: "km",
    9: "mil",
    10: "yd",
    13: "um",
    14: "dm",
}
"""Code of ``$INSUNITS`` → unit of length."""
NESTED = 8
"""Upper limit of the depth of blocks in blocks."""
WIDE = 0.6
"""Usual width of a character over its height."""
SHIFTS = {"LEFT": 0.5, "CENTER": 0.0, "RIGHT": -0.5}
"""Alignment of a text → distance of its middle from its anchor, over its width."""


def read_drawing(path: Path, unit: str | None) -> Drawing:
    """Lines, circles and texts of the model space of a DXF file.

    Parameters
    ----------
    path : of the file
    unit : of the drawing, in place of ``$INSUNITS``

    Raises
    ------
    FileError, ModelError
        Not a DXF file; a coordinate is not finite; too many entities.
    UnsupportedError
        ezdxf is not installed.
    """
    document = _document(path)
    code = int(document.header.get("$INSUNITS", 0))
    drawing = Drawing(path, unit or UNITS.get(code, "mm"))
    if unit is None and code not in UNITS:
        reason = "the file states no unit of length that is known, and millimetres are assumed; "
        drawing.omit(f"{path}: header", f"$INSUNITS = {code}", reason + 'otherwise give unit="in"')
    return _Reader(drawing, document).read()


def _document(path: Path) -> Any:
    ezdxf = optional_package("ezdxf", f"reading {path}")
    if readable(path, WEIGHT) == 0:
        raise FileError(f"{path}: the file is empty; save the drawing again as DXF")
    try:
        return ezdxf.readfile(path)
    except Exception as error:  # ezdxf raises errors of many types for damaged files
        reason = (str(error) or type(error).__name__).partition("\n")[0][:200]
        raise FileError(
            f"{path}: cannot be read as DXF ({reason}); save it again as DXF R2000 or later"
        ) from None


class _Reader:
    """Conversion of entities of ezdxf.

    Parameters
    ----------
    drawing : gets the entities
    document : of ezdxf
    """

    def __init__(self, drawing: Drawing, document: Any):
        self.drawing, self.document, self.visited = drawing, document, 0
        self.frozen = {e.dxf.name.lower() for e in document.layers if e.is_frozen()}
        self.hidden = self.frozen | {e.dxf.name.lower() for e in document.layers if e.is_off()}
        self.group_of = {
            entity.dxf.handle: name for name, group in document.groups for entity in group
        }
        self.fills: list[tuple[np.ndarray, str]] = []
        self.arcs: list[Arc] = []

    def read(self) -> Drawing:
        for entity, blocks in self._entities(self.document.modelspace(), ()):
            try:
                self._convert(entity, blocks)
            except (ArithmeticError, ValueError, TypeError, AttributeError, IndexError) as error:
                place = self._place(entity)
                raise ModelError(f"cannot be read ({error}); redraw or delete it", place) from None
        add_circles_of_arcs(self.drawing, self.arcs)
        self.drawing.convert(lambda entity: [self._filled(entity)])
        for _, place in self.fills:
            self.drawing.omit(place, "fill", "fills no circle")
        for layout in self.document.layouts:
            count = sum(entity.dxftype() != "VIEWPORT" for entity in layout)
            if not layout.is_modelspace and count:
                place = f"{self.drawing.path}: layout {layout.name!r}"
                reason = "is a sheet for printing; draw in the model space"
                self.drawing.omit(place, f"{count} entities", reason)
        return self.drawing

    def _entities(self, entities: Iterable[Any], blocks: tuple[str, ...]) -> Iterator[Any]:
        """Entities with the names of the blocks that contain them."""
        for entity in entities:
            self.visited += 1
            if self.visited > VISITED:
                raise ModelError(
                    f"the drawing has more than {VISITED} entities; save the mechanism alone",
                    str(self.drawing.path),
                )
            if entity.dxftype() != "INSERT":
                yield entity, blocks
            elif entity.mcount > 1 or len(blocks) >= NESTED:
                self._omit(entity, "an array of blocks, or too deeply nested; explode it")
            elif entity.dxf.get("invisible", 0) or self._layer(entity) in self.frozen:
                self._omit(entity, "its layer is off or frozen")
            else:
                name = f"{entity.dxf.name}:{entity.dxf.handle or self.visited}"
                inside = [*entity.virtual_entities(skipped_entity_callback=self._omit_part)]
                for part in inside:
                    if part.dxf.get("layer", "0") == "0":  # by the rules of DXF, that of the block
                        part.dxf.layer = entity.dxf.get("layer", "0")
                yield from self._entities([*inside, *entity.attribs], (*blocks, name))

    @staticmethod
    def _layer(entity: Any) -> str:
        """Layer in lower case; DXF ignores the case of layer names."""
        return str(entity.dxf.get("layer", "0")).lower()

    def _convert(self, entity: Any, blocks: tuple[str, ...]) -> None:
        kind, layer = entity.dxftype(), entity.dxf.get("layer", "0")
        if kind in ("VIEWPORT", "ATTDEF"):  # windows of layouts, and defaults of attributes
            return
        if layer.lower() in self.hidden or entity.dxf.get("invisible", 0):
            self._omit(entity, "its layer is off or frozen")
            return
        group = self.group_of.get(entity.dxf.handle, "")
        words = (layer, *blocks, *([group] if group else []))
        role = role_of(words)
        if role is Role.IGNORED:
            self._omit(entity, "its layer is no part of the mechanism, by its name")
            return
        data: dict[str, Any] = {"place": self._place(entity), "words": words}
        joined = group or (blocks[-1] if blocks and not blocks[-1].startswith("*") else "")
        data["group"] = joined or group_of((layer,))
        if kind in ("HATCH", "SOLID", "TRACE", "MPOLYGON"):
            self.fills.append((_middle(entity), data["place"]))
        elif kind in ("TEXT", "MTEXT", "ATTRIB"):
            self.drawing.add(Label(**data, **_text(entity)))
        elif kind in ("CIRCLE", "POINT"):
            place = entity.dxf.center if kind == "CIRCLE" else entity.dxf.location
            center = self._plane(entity, [place], kind == "CIRCLE")
            radius = float(entity.dxf.radius) if kind == "CIRCLE" else 0.0
            if center is not None:
                self.drawing.add(Circle(**data, center=center[0], radius=abs(radius)))
        elif kind == "ARC" and role is Role.MOTOR:
            center = self._plane(entity, [entity.dxf.center], True)
            if center is not None:
                self.drawing.add(Arrow(**data, points=center))
        elif kind in ("LINE", "LWPOLYLINE", "POLYLINE"):
            self._line(entity, data, role)
        elif kind in ("ARC", "ELLIPSE") and (arc := self._arc(entity, data)) is not None:
            self.arcs.append(arc)
        else:
            self._omit(entity, CURVES if kind in ("ARC", "SPLINE", "ELLIPSE") else "is not used")

    def _arc(self, entity: Any, data: dict[str, Any]) -> Arc | None:
        """Part of a circle; None for other ellipses."""
        if entity.dxftype() == "ARC":
            center = self._plane(entity, [entity.dxf.center], True)
            radius, start, end = entity.dxf.radius, entity.dxf.start_angle, entity.dxf.end_angle
            span = np.radians((end - start) % 360.0) or 2 * np.pi
        else:
            center = self._plane(entity, [entity.dxf.center], False)
            radius = entity.dxf.major_axis.magnitude
            span = (entity.dxf.end_param - entity.dxf.start_param) % (2 * np.pi) or 2 * np.pi
            if abs(abs(entity.dxf.ratio) - 1.0) > SAME:
                return None
        if center is None:
            return None
        return Arc(center[0], float(radius), float(span), entity.dxftype(), data)

    def _line(self, entity: Any, data: dict[str, Any], role: Role) -> None:
        kind = entity.dxftype()
        bulges = width = None
        if kind == "LINE":
            corners = self._plane(entity, [entity.dxf.start, entity.dxf.end], False)
            closed = False
        elif kind == "LWPOLYLINE":
            rows = np.array(entity.get_points("xyb"), dtype=float).reshape(-1, 3)
            corners = self._plane(entity, rows[:, :2], True)
            bulges, closed = rows[:, 2], bool(entity.closed)
            width = float(entity.dxf.get("const_width", 0.0))
        elif entity.is_2d_polyline:
            corners = self._plane(entity, [v.dxf.location for v in entity.vertices], True)
            bulges = np.array([v.dxf.get("bulge", 0.0) for v in entity.vertices])
            closed = bool(entity.is_closed)
        elif entity.is_3d_polyline:
            corners = self._plane(entity, [v.dxf.location for v in entity.vertices], False)
            closed = bool(entity.is_closed)
        else:
            self._omit(entity, "is a surface; draw lines in the plane")
            return
        if corners is None or len(corners) == 0:
            return
        if role is Role.MOTOR:
            self.drawing.add(Arrow(**data, points=corners))
            return
        converted = outline(corners, closed, bulges, width or 0.0, data)
        if isinstance(converted, Line) and bulges is not None and bulges.any():
            self._omit(entity, "its arcs are replaced by straight lines between its corners")
        self.drawing.add(converted)

    def _plane(self, entity: Any, points: Any, is_local: bool) -> np.ndarray | None:
        """(n, 2) coordinates in the drawing; None, with an omission, outside of its plane."""
        rows = np.array([tuple(point) for point in points], dtype=float).reshape(len(points), -1)
        if rows.shape[1] == 3 and np.ptp(rows[:, 2]) > 1e-9 * np.abs(rows).max():
            self._omit(entity, "leaves the plane of the drawing")
            return None
        normal = np.array(tuple(entity.dxf.get("extrusion", (0, 0, 1))), dtype=float)
        if is_local and (np.abs(normal[:2]) > 1e-9 * np.abs(normal).max()).any():
            self._omit(entity, "is not parallel to the plane of the drawing")
            return None
        return rows[:, :2] * ([-1.0, 1.0] if is_local and normal[2] < 0 else [1.0, 1.0])

    def _filled(self, entity: Any) -> Any:
        """A circle with its fill."""
        if not isinstance(entity, Circle):
            return entity
        inside = [
            fill
            for fill in self.fills
            if np.linalg.norm(fill[0] - entity.center) <= entity.radius / 4
        ]
        self.fills = [fill for fill in self.fills if not any(fill is other for other in inside)]
        return Circle(**(vars(entity) | {"filled": True})) if inside else entity

    def _place(self, entity: Any) -> str:
        handle, layer = entity.dxf.get("handle") or "in a block", entity.dxf.get("layer", "0")
        return f"{self.drawing.path}: {entity.dxftype()} {handle} on layer {layer!r}"

    def _omit_part(self, entity: Any, reason: str) -> None:
        self._omit(entity, f"cannot be moved with its block ({reason}); explode the block")

    def _omit(self, entity: Any, reason: str) -> None:
        self.drawing.omit(self._place(entity), entity.dxftype(), reason)


def _middle(entity: Any) -> np.ndarray:
    """(2,) middle of a filled area; not a number without one."""
    points: list[Any] = []
    if entity.dxftype() in ("SOLID", "TRACE"):
        points = list(entity.vertices())
    else:
        for path in entity.paths.paths:
            points += getattr(path, "vertices", [])
            for edge in getattr(path, "edges", []):
                points += [edge.center] if hasattr(edge, "center") else [edge.start_point]
    rows = np.array([tuple(point)[:2] for point in points], dtype=float).reshape(-1, 2)
    return (rows.min(axis=0) + rows.max(axis=0)) / 2 if len(rows) else np.full(2, np.nan)


def _text(entity: Any) -> dict[str, Any]:
    """Content of a text, and its middle by the usual width of characters."""
    text = entity.plain_text() if entity.dxftype() == "MTEXT" else entity.dxf.text
    text = " ".join(str(text).split())
    if entity.dxftype() == "MTEXT":
        anchor, height = entity.dxf.insert, float(entity.dxf.get("char_height", 1.0))
        attachment = int(entity.dxf.get("attachment_point", 1))
        shift = list(SHIFTS.values())[(attachment - 1) % 3]
        rise = ((attachment - 1) // 3 - 1) * 0.5
    else:
        alignment, anchor, _ = entity.get_placement()
        height = float(entity.dxf.get("height", 1.0))
        words = alignment.name.split("_")
        shift = SHIFTS.get(words[-1], 0.0)
        rise = {"TOP": -0.5, "MIDDLE": 0.0}.get(words[0], 0.5)
    angle = np.radians(float(entity.dxf.get("rotation", 0.0)))
    along = np.array([np.cos(angle), np.sin(angle)])
    across = np.array([-np.sin(angle), np.cos(angle)])
    middle = np.array(tuple(anchor)[:2], dtype=float)
    middle = middle + shift * WIDE * height * len(text) * along + rise * height * across
    return {"position": middle, "text": text}
