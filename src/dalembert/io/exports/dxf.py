"""DXF drawings of positions of planar mechanisms.

Bodies are lines on layers with their names, pins are circles, those of the ground on the layer
``ground``; guides are on layers with ``slot``, sliding bodies on layers with ``block``. A drawing
with these conventions can be imported as a mechanism. Other things are on ``construction`` layers.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from dalembert.elements.look import Link
from dalembert.elements.pair import ConstantDistance
from dalembert.elements.planar.prismatic import Prismatic, SlidingJoint
from dalembert.elements.planar.revolute import Revolute
from dalembert.elements.planar.weld import Weld
from dalembert.elements.point import Point
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.io.exports.exported import Files
from dalembert.io.exports.shapes.scene import start_recording
from dalembert.model.graph.model import Model
from dalembert.packages import optional_package
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.scene import is_spatial
from dalembert.symbolic.formulas.expression import Expression

UNITS = {"mm": (4, 1000.0), "m": (6, 1.0)}
"""Unit of length → code of ``$INSUNITS`` and factor."""
PIN, BLOCK, TEXT = 0.015, 0.06, 0.02
"""Radius of pins, width of blocks and height of texts, relative to the size."""
TRACES, SPRINGS, DISCS, LABELS = (
    f"construction_{what}" for what in ("traces", "springs", "circles", "names")
)
"""Layers that are no part of the mechanism."""
COLOURS = (5, 1, 3, 30, 6, 4)
"""Colours of bodies in turn, by their AutoCAD indices."""


def dxf_file(
    source: Any,
    name: str,
    time: float | None = None,
    unit: str = "mm",
    trace: Sequence[str] = (),
    parameters: Mapping[str, float] | None = None,
) -> Files:
    """A DXF drawing of a planar mechanism, of a model at its start, of a motion at a time.

    Parameters
    ----------
    time : of a motion [s], its first instant by default
    unit : of the drawing, ``"mm"`` or ``"m"``
    trace : points whose paths are drawn, such as ``["coupler.end"]``
    parameters : values of a model other than its own

    Raises
    ------
    UnsupportedError
        A spatial mechanism; ezdxf is not installed.
    """
    model = source if isinstance(source, Model) else source.model
    if is_spatial(model):
        spatial = next(body.name for body in model.bodies if body.dimension == 3)
        raise UnsupportedError(f"DXF drawings are planar, and {spatial!r} is a spatial body")
    if unit not in UNITS:
        raise UnsupportedError(f"unit {unit!r} of a drawing: choose {' or '.join(UNITS)}")
    if isinstance(source, Model):
        if time is not None:
            raise AnalysisError("time= is for motions; a model is drawn at its start")
        recording: LabelledRecording = start_recording(source, parameters)
    else:
        recording = source if time is None else source.at([time])
    sheet = _Sheet(recording, unit)
    sheet.draw()
    for point in trace:
        path = np.atleast_2d(source.values(f"{point}.position")) if source is not model else None
        sheet.trace(path if path is not None else sheet.values(model[f"{point}.position"].sx)[None])
    return Files({f"{name}.dxf": sheet.text().encode("utf-8")})


class _Sheet:
    """A drawing of the first instant of a recording."""

    def __init__(self, recording: LabelledRecording, unit: str):
        ezdxf = optional_package("ezdxf", "DXF")
        self.recording, self.model = recording, recording.model
        code, self.factor = UNITS[unit]
        self.document = ezdxf.new("R2010")
        self.document.header["$INSUNITS"] = code
        self.space = self.document.modelspace()
        self.colours: dict[str, int] = {}
        places = [self.place(p) for body in self.model.bodies for p in body.points.values()]
        places += [self.place(p) for pair in self._joints() for p in pair.end_points]
        spread = np.ptp(np.array(places or [np.zeros(2)]), axis=0).max()
        self.size = float(spread) or 1.0

    def values(self, formula: Any) -> np.ndarray:
        """Components of a formula at the first instant."""
        return np.atleast_1d(
            np.ravel(self.recording.values(Expression(formula)))[: formula.numel()]
        )

    def place(self, point: Point) -> np.ndarray:
        """(2,) position of a point [m]."""
        values = self.recording.values(Expression(point.position.sx))
        return np.atleast_2d(values)[0][:2]

    def _joints(self) -> list[Any]:
        return [c for c in self.model.constraints if c.end_points is not None]

    # layers and entities ------------------------------------------------------------------------
    def layer(self, name: str, colour: int = 7) -> dict[str, str]:
        if name not in self.document.layers:
            self.document.layers.add(name, color=colour)
        return {"layer": name}

    def line(self, start: np.ndarray, end: np.ndarray, layer: dict[str, str]) -> None:
        self.space.add_line(start * self.factor, end * self.factor, dxfattribs=layer)

    def circle(self, center: np.ndarray, radius: float, layer: dict[str, str]) -> None:
        self.space.add_circle(center * self.factor, radius * self.factor, dxfattribs=layer)

    def label(self, text: str, place: np.ndarray) -> None:
        height = TEXT * self.size * self.factor
        entity = self.space.add_text(text, height=height, dxfattribs=self.layer(LABELS, 8))
        entity.set_placement((place + 2 * PIN * self.size) * self.factor)

    def trace(self, path: np.ndarray) -> None:
        """A path of a point."""
        self.space.add_lwpolyline(path[:, :2] * self.factor, dxfattribs=self.layer(TRACES, 8))

    def text(self) -> str:
        stream = io.StringIO()
        self.document.write(stream)
        return stream.getvalue()

    # the mechanism ------------------------------------------------------------------------------
    def draw(self) -> None:
        """Draw bodies, joints and springs."""
        pins: dict[str, list[np.ndarray]] = {body.name: [] for body in self.model.bodies}
        blocks = set()
        for joint in self._joints():
            if isinstance(joint, Prismatic):
                blocks.add(joint.ends()[1].name)
            for point in joint.end_points:
                if point.body.name in pins:
                    pins[point.body.name].append(self.place(point))
            self._joint(joint)
        for number, body in enumerate(self.model.bodies):
            own = [self.place(point) for point in body.points.values()]
            self._body(body, [*pins[body.name], *own], number, body.name in blocks)
        for force in self.model.forces:
            for look in force.look():
                if isinstance(look, Link):
                    ends = self.place(look.point_i), self.place(look.point_j)
                    self.line(*ends, self.layer(SPRINGS, 8))

    def _body(self, body: Any, points: list[np.ndarray], number: int, is_block: bool) -> None:
        """Lines through the points of a body, on a layer with its name."""
        layer = self.layer(body.name, COLOURS[number % len(COLOURS)])
        corners = outline(points, 1e-6 * self.size)
        if len(corners) == 2:
            self.line(corners[0], corners[1], layer)
        elif len(corners) > 2:
            self.space.add_lwpolyline(np.array(corners) * self.factor, close=True, dxfattribs=layer)
        elif not is_block and corners:
            (center,) = [self.values(body.pose_position)] if body.rotates else [corners[0]]
            if np.linalg.norm(center - corners[0]) > 1e-6 * self.size:
                self.line(corners[0], center, layer)

    def _joint(self, joint: Any) -> None:
        """Pins as circles, guides and blocks of sliding joints."""
        grounded = any(body.name == "ground" for body in joint.ends())
        layer = self.layer("ground", 8) if grounded else self.layer("pins", 7)
        place = self.place(joint.end_points[1])
        if isinstance(joint, SlidingJoint):
            self._guide(joint, place)
            if isinstance(joint, Prismatic):
                return
            layer = self.layer("pins", 7)
        elif isinstance(joint, Weld):
            return
        elif isinstance(joint, ConstantDistance):
            self.line(self.place(joint.end_points[0]), place, self.layer(joint.name, 7))
            self.circle(self.place(joint.end_points[0]), PIN * self.size, layer)
            layer = self.layer("pins", 7)
        elif not isinstance(joint, Revolute):
            layer = self.layer(DISCS, 8)
        self.circle(place, PIN * self.size, layer)
        self.label(joint.name, place)

    def _guide(self, joint: Any, place: np.ndarray) -> None:
        """The line of a sliding joint, and the block of a prismatic one."""
        direction = self.values(joint.direction)
        half = BLOCK * self.size
        owner = joint.ends()[0].name
        layer = self.layer(f"{owner}_slot", 8 if owner == "ground" else 7)
        # a guide up to the point of the other body could pass through pins that do not slide in it
        self.line(place - 3 * half * direction, place + 3 * half * direction, layer)
        if isinstance(joint, Prismatic):
            across = np.array([-direction[1], direction[0]])
            corners = [
                place + half * (a * direction + 0.6 * b * across)
                for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
            ]
            self.space.add_lwpolyline(
                np.array(corners) * self.factor,
                close=True,
                dxfattribs=self.layer(f"{joint.ends()[1].name}_block", 7),
            )


def outline(points: Sequence[np.ndarray], tolerance: float) -> list[np.ndarray]:
    """Corners of the convex hull of points; two for points on a line, one for a single place.

    Examples
    --------
    >>> import numpy as np
    >>> from dalembert.io.exports.dxf import outline
    >>> square = [np.array(p) for p in ((0.0, 0.0), (1, 0), (1, 1), (0, 1), (0.5, 0.5))]
    >>> len(outline(square, 1e-9)), len(outline([np.zeros(2), np.ones(2), 0.5 * np.ones(2)], 1e-9))
    (4, 2)
    """
    distinct: list[np.ndarray] = []
    for point in points:
        if all(np.linalg.norm(point - other) > tolerance for other in distinct):
            distinct.append(point)
    if len(distinct) < 2:
        return distinct
    table = np.array(distinct)
    center = table.mean(axis=0)
    _, sizes, directions = np.linalg.svd(table - center)
    if len(distinct) == 2 or sizes[-1] <= tolerance:
        along = (table - center) @ directions[0]
        return [table[int(np.argmin(along))], table[int(np.argmax(along))]]
    return [table[k] for k in ConvexHull(table).vertices]
