"""Scene of a mechanism as plain data: numbers, points, columns over time and reactions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Element
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.elements.look import Belt
from dalembert.elements.point import AXES, Point
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.pivots import Pivots
from dalembert.results.sources import Track, numbers
from dalembert.symbolic.formulas.expression import Expression

PointData = dict[str, Any]


class SceneCollector:
    """Collector of the parts of a scene.

    Parameters
    ----------
    motion : motion whose elements are drawn
    keep : instants
    loads : whether forces, moments and stops are drawn

    Attributes
    ----------
    size : of the mechanism, for symbols of relative size
    shapes : name of a body → its shapes
    joints, links, symbols : primitives between bodies or of their own
    """

    size = 1.0
    dimension: int

    def __init__(self, motion: LabelledRecording, keep: np.ndarray, loads: bool):
        self.motion, self.model, self.keep, self.loads = motion, motion.model, keep, loads
        self.data, self.parameters = motion.contents, self.model.equations.p
        self.elements = [*self.model.constraints, *self.model.forces]
        self.elements += [
            e for e in self.model.parts.elements.values() if isinstance(e, Collisions)
        ]
        self.pivots = Pivots(self.elements)
        flexible = (b for b in self.model.bodies if isinstance(b, FloatingFrame))
        self.sections = [section for body in flexible for section in body.sections.values()]
        names = ["ground", *(b.display_name for b in (*self.model.bodies, *self.sections))]
        self.shapes: dict[str, list[dict]] = {name: [] for name in names}
        self.joints: list[dict] = []
        self.links: list[dict] = []
        self.symbols: list[dict] = []
        self.places: dict[int, tuple[Point, list[float]]] = {}
        self.time_dependent: list[tuple[dict, tuple[str, ...], ca.SX]] = []

    # numbers ---------------------------------------------------------------------------
    def number(self, sx: ca.SX) -> list[float]:
        """Components of a formula of parameters, which carry it."""
        column = ca.vec(ca.densify(sx))
        if column.is_constant():
            entries: list[Any] = column.nonzeros()
            return [float(entry) for entry in entries]
        value = ca.Function("n", [self.parameters], [column])
        return numbers(value(self.motion.parameters).full().ravel(), column)

    def size_of(self, sx: ca.SX) -> float:
        """Value of a scalar formula of parameters, which carries it."""
        return self.number(sx)[0]

    def padded(self, sx: ca.SX) -> ca.SX:
        """A vector padded to the dimension of the drawing."""
        return ca.vertcat(sx, ca.SX.zeros(max(0, self.dimension - sx.numel())))

    def local(self, point: Point) -> list[float]:
        """Coordinates of a point in the frame of its body."""
        if id(point) not in self.places:
            self.locate([point])
        return list(self.places[id(point)][1])

    def locate(self, points: Sequence[Point]) -> None:
        """Evaluate the coordinates of points in the frames of their bodies, in one operation."""
        coordinates = self.number(ca.vertcat(*(self.padded(p.local.sx) for p in points)))
        for k, point in enumerate(points):
            own = coordinates[k * self.dimension : (k + 1) * self.dimension]
            self.places[id(point)] = (point, own)

    def point_data(self, point: Point) -> PointData:
        """Data of a point in pages."""
        return {"body": point.body.display_name, "point": self.local(point)}

    def components(self, name: str, vector: ca.SX) -> tuple[str, ...]:
        """Names of the columns of a vector; a planar moment has one."""
        axes = AXES[: vector.numel()]
        return tuple(f"{name}_{axis}" for axis in axes) if len(axes) > 1 else (name,)

    def fill_in(self) -> None:
        """Fill in the columns of time-dependent symbols, in one pass over the states."""
        if not self.time_dependent:
            return
        columns = self.motion.columns([Expression(sx) for _, _, sx in self.time_dependent])
        for (symbol, names, sx), values in zip(self.time_dependent, columns, strict=True):
            table = values[self.keep].reshape(len(self.keep), len(names))
            symbol |= Track(table, sx).named(names)

    def recorded(self, variable: str, **labels: str) -> Track:
        """A recorded variable over time."""
        values = self.data.at(variable, **labels)[self.keep].reshape(len(self.keep), -1)
        source = self.motion.source(variable, **labels)
        return Track(values, source if isinstance(source, ca.SX) else None)

    def load(self, name: str, vector: ca.SX, symbol: PointData) -> None:
        """Record an applied force or moment over time."""
        if self.loads:
            self.symbols.append(symbol)
            self.time_dependent.append((symbol, self.components(name, vector), vector))

    def wheels(self, look: Belt) -> tuple[list[PointData], bool]:
        """Wheels of a belt, with radii in its ratio, and whether it is crossed."""
        pivots = [self.pivots.between(look.carrier, b) for b in (look.body_i, look.body_j)]
        ratio, turns = self.size_of(look.ratio), ca.fabs(look.ratio)
        unit = 0.3 * self.distance(*pivots) / (turns + 1)
        wheels = [
            self.anchor(pivot) | {"radius": self.size_of(radius)}
            for pivot, radius in zip(pivots, (unit * turns, unit), strict=True)
        ]
        return wheels, ratio < 0

    def distance(self, point_i: Point, point_j: Point) -> float:
        """Distance of two points at the first instant."""
        return float(np.linalg.norm(self.start(point_i) - self.start(point_j)))

    def limits(self, travels: ca.SX) -> tuple[float, float]:
        """Lower and upper limit of travels along a line; zero if there are none."""
        travel = self.motion.values(Expression(travels))[self.keep]
        travel = travel[np.isfinite(travel)]
        return (float(travel.min()), float(travel.max())) if travel.size else (0.0, 0.0)

    def start(self, point: Point) -> np.ndarray:
        """Position of a point at the first instant."""
        if point.body.name == "ground":
            return np.array(self.local(point))
        return np.atleast_1d(self.motion.values(self.padded_position(point))[self.keep[0]])

    def padded_position(self, point: Point) -> Expression:
        """Position of a point, padded to the dimension of the drawing."""
        return Expression(self.padded(point.position.sx))

    def axis(self, point: Point) -> list[float] | None:
        """Axis of the rotation at a point; None if it has none."""
        return None

    def anchor(self, point: Point) -> PointData:
        """Data of a point, with its axis."""
        return self.point_data(point) | {"axis": self.axis(point)}

    def moment(self, sx: ca.SX) -> ca.SX:
        """A moment, padded to the rotation axes of the drawing."""
        return sx

    def reaction(self, joint: Element) -> dict[str, list[float]]:
        """Columns of the reaction force and moment of a joint."""
        if joint.name not in self.data.labels("joint"):
            return {}
        force, moment = (
            self.recorded(f"reaction_{kind}", joint=joint.name) for kind in ("force", "moment")
        )
        if not np.isfinite(force.values).any():
            return {}
        threshold = 1e-9 * self.size * np.nanmax(np.abs(force.values))
        large = np.where(np.abs(moment.values) > threshold, moment.values, 0.0)
        columns: dict[str, list[float]] = {}
        for name, track in (("force", force), ("moment", Track(large, moment.sx))):
            columns |= track.named(self.components(name, ca.SX(track.values.shape[1], 1)))
        return columns
