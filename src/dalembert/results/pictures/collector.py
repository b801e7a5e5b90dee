"""Scene of a mechanism as plain data: numbers, points, columns over time and reactions."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.elements.look import Belt
from dalembert.elements.point import AXES, Point
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.pivots import Pivots
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
        self.time_dependent: list[tuple[dict, tuple[str, ...], ca.SX]] = []

    # numbers ---------------------------------------------------------------------------
    def number(self, sx: ca.SX) -> np.ndarray:
        """Value of a formula of parameters."""
        value = ca.Function("n", [self.parameters], [ca.densify(sx)])
        return np.asarray(value(self.motion.parameters).full()).ravel()

    def size_of(self, sx: ca.SX) -> float:
        """Value of a scalar formula of parameters."""
        return float(self.number(sx)[0])

    def padded(self, sx: ca.SX) -> ca.SX:
        """A vector padded to the dimension of the drawing."""
        return ca.vertcat(sx, ca.SX.zeros(max(0, self.dimension - sx.numel())))

    def local(self, point: Point) -> list[float]:
        """Coordinates of a point in the frame of its body."""
        return self.number(self.padded(point.local.sx)).tolist()

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
        for (symbol, names, _), values in zip(self.time_dependent, columns, strict=True):
            rows = values[self.keep].reshape(len(self.keep), len(names)).T
            symbol |= dict(zip(names, rows.tolist(), strict=True))

    def load(self, name: str, vector: ca.SX, symbol: PointData) -> None:
        """Record an applied force or moment over time."""
        if self.loads:
            self.symbols.append(symbol)
            self.time_dependent.append((symbol, self.components(name, vector), vector))

    def wheels(self, look: Belt) -> tuple[list[PointData], bool]:
        """Wheels of a belt, with radii in its ratio, and whether it is crossed."""
        pivots = [self.pivots.between(look.carrier, b) for b in (look.body_i, look.body_j)]
        ratio, (p, q) = self.size_of(look.ratio), [self.start(pivot) for pivot in pivots]
        unit = 0.3 * float(np.linalg.norm(p - q)) / (abs(ratio) + 1)
        wheels = [
            self.anchor(pivot) | {"radius": unit * turns}
            for pivot, turns in zip(pivots, (abs(ratio), 1.0), strict=True)
        ]
        return wheels, ratio < 0

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

    def reaction(self, joint: Any) -> dict[str, list[float]]:
        """Columns of the reaction force and moment of a joint."""
        if joint.name not in self.data.labels("joint"):
            return {}
        force, moment = (
            self.data.at(f"reaction_{k}", joint=joint.name)[self.keep] for k in ("force", "moment")
        )
        if not np.isfinite(force).any():
            return {}
        threshold = 1e-9 * self.size * np.nanmax(np.abs(force))
        moment = np.where(np.abs(moment) > threshold, moment, 0.0)
        columns_by_name: dict[str, list[float]] = {}
        for name, table in (("force", force), ("moment", moment.reshape(len(self.keep), -1))):
            columns = self.components(name, ca.SX(table.shape[1], 1))
            columns_by_name |= dict(zip(columns, table.T.tolist(), strict=True))
        return columns_by_name
