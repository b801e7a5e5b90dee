"""Scene of a mechanism as plain data: numbers, points, columns over time and reactions."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Element
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.elements.look import Belt, Limit, Pin, SlotPin
from dalembert.elements.planar.body import Body, perpendicular, rotation
from dalembert.elements.point import AXES, Point
from dalembert.results.labelled import LabelledRecording
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

    def reaction(self, joint: Element) -> dict[str, list[float]]:
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


WALL_POSITION = 0.6
"""Relative position of the wall of a limited angle, from the axis to the far end of the body."""


class Pivots:
    """Centres of rotation of bodies, from the pins of a mechanism.

    Parameters
    ----------
    elements : constraints and forces
    """

    def __init__(self, elements: list[Element]):
        self.ends: dict[tuple[str, str], Point] = {}
        looks = [look for element in elements for look in element.look()]
        for look in looks:
            if isinstance(look, Pin | SlotPin) and isinstance(look.base, Point):
                for pin_point, base_point in ((look.point, look.base), (look.base, look.point)):
                    self.ends.setdefault((base_point.body.name, pin_point.body.name), pin_point)

    def between(self, body_i: BodyElement | None, body_j: BodyElement) -> Point:
        """The pin of two bodies, else that of one of them on the ground, else its mass centre."""
        base = body_i.name if body_i is not None else "ground"
        pairs = [(base, body_j.name), ("ground", body_j.name), ("ground", base)]
        pin = next((self.ends[pair] for pair in pairs if pair in self.ends), None)
        if pin is not None:
            return pin
        return body_i.center if body_j.name == "ground" and body_i is not None else body_j.center

    def wall(self, look: Limit, bodies: list[Body], reach: dict[str, float]) -> ca.SX | None:
        """Position (2,) of the wall that limits a coordinate, and its normal (2,) to the free side.

        The wall is where the last of the bodies that move the coordinate would touch it, at
        ``reach`` (by name) from the mass centre. None if no body moves the coordinate.
        """
        moving = [b for b in bodies if ca.jacobian(look.coordinate, b.pose).nnz()]
        if not moving:
            return None
        body, distance = moving[-1], look.value - look.coordinate
        sign = -1 if look.above else 1
        wall = straight_wall(look, body, reach.get(body.name, 0.0))
        if wall is not None or body.dimension == 3:
            return wall
        pivot = self.between(moving[0] if len(moving) > 1 else None, body).position.sx
        angle = distance / ca.jacobian(look.coordinate, body.pose_angle)
        arm = ca.mtimes(rotation(angle), self.far_point(body).position.sx - pivot)
        normal = sign * ca.jacobian(look.coordinate, body.pose_angle) * perpendicular(arm)
        return ca.vertcat(pivot + WALL_POSITION * arm, normal / ca.sqrt(ca.sumsqr(normal)))

    def far_point(self, body: Body) -> Point:
        """The point of a body that shows its rotation best."""
        points = list(body.points.values())
        pins = [p for (_, name), p in self.ends.items() if name == body.name]
        distant = [p for p in points if all(_differ(p, q) for q in pins)]
        return (distant or points or [body.center])[-1]


def straight_wall(look: Limit, body: Body, reach: float) -> ca.SX | None:
    """Position and normal (2d,) of the wall of a straight path; None for a rotation."""
    origin = body.pose_position if body.dimension == 2 else getattr(body, "origin", body.pose[:3])
    slope = ca.jacobian(look.coordinate, origin).T
    if not slope.nnz():
        return None
    size = ca.sumsqr(slope)
    normal = (-1 if look.above else 1) * slope / ca.sqrt(size)
    distance = look.value - look.coordinate
    return ca.vertcat(origin + slope * (distance / size) - reach * normal, normal)


def _differ(p: Point, q: Point) -> bool:
    difference = p.local.sx - q.local.sx
    return not difference.is_constant() or float(ca.norm_2(difference)) > 0
