"""The primitives of a mechanism, each as plain data with where and how it moves.

Here are those that look alike in the plane and in space.
"""

from __future__ import annotations

import re
from functools import singledispatchmethod
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Look
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.elements.look import (
    Arrow,
    Ball,
    Belt,
    Contact,
    Link,
    Path,
    Rail,
    Segment,
    Twist,
)
from dalembert.elements.point import AXES, Point
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.pivots import Pivots
from dalembert.symbolic.formulas.expression import Expression

CURVE_SAMPLES = 181
Place = dict[str, Any]


class Sketch:
    """Takes primitives one by one.

    Parameters
    ----------
    motion : whose elements are drawn
    keep : instants
    loads : forces, moments and stops are drawn too

    Attributes
    ----------
    size : of the mechanism, for what has no size of its own
    shapes : name of a body → what lies on it
    joints, links, symbols : what stands between bodies, or alone
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
        self.later: list[tuple[dict, tuple[str, ...], ca.SX]] = []

    # numbers ---------------------------------------------------------------------------
    def number(self, sx: ca.SX) -> np.ndarray:
        """A formula of parameters."""
        value = ca.Function("n", [self.parameters], [ca.densify(sx)])
        return np.asarray(value(self.motion.parameters).full()).ravel()

    def size_of(self, sx: ca.SX) -> float:
        """A formula of parameters with one value."""
        return float(self.number(sx)[0])

    def widened(self, sx: ca.SX) -> ca.SX:
        """A vector of the plane in as many components as the drawing has."""
        return ca.vertcat(sx, ca.SX.zeros(max(0, self.dimension - sx.numel())))

    def local(self, point: Point) -> list[float]:
        """Coordinates of a point in its body."""
        return self.number(self.widened(point.local.sx)).tolist()

    def place(self, point: Point) -> Place:
        """A point, as pages read it."""
        return {"body": point.body.display_name, "point": self.local(point)}

    def components(self, name: str, vector: ca.SX) -> tuple[str, ...]:
        """Names of a vector's columns; in the plane a moment has only one."""
        axes = AXES[: vector.numel()]
        return tuple(f"{name}_{axis}" for axis in axes) if len(axes) > 1 else (name,)

    def fill_in(self) -> None:
        """Columns of what moves by itself, all in one pass over the states."""
        if not self.later:
            return
        columns = self.motion.columns([Expression(sx) for _, _, sx in self.later])
        for (described, names, _), values in zip(self.later, columns, strict=True):
            rows = values[self.keep].reshape(len(self.keep), len(names)).T
            described |= dict(zip(names, rows.tolist(), strict=True))

    # primitives ------------------------------------------------------------------------
    @singledispatchmethod
    def draw(self, look: Look, element: Any) -> None:
        """Note what a primitive of an element needs to be drawn."""
        raise NotImplementedError(f"{type(look).__name__} has no drawing")

    @draw.register
    def _(self, look: Segment, element: Any) -> None:
        ends = {"from": self.local(look.point_i), "to": self.local(look.point_j)}
        self.shapes[look.point_i.body.display_name].insert(0, {"kind": "bar", **ends})

    @draw.register
    def _(self, look: Ball, element: Any) -> None:
        shape = {"kind": "particle", "center": self.local(look.point)}
        self.shapes[look.point.body.display_name].append(shape)

    @draw.register
    def _(self, look: Rail, element: Any) -> None:
        travel = self.motion.values(Expression(look.travel))[self.keep]
        travel = travel[np.isfinite(travel)]
        low, high = (float(travel.min()), float(travel.max())) if travel.size else (0.0, 0.0)
        margin, axis = 0.12 * self.size, self.number(self.widened(look.direction))
        axis, origin = axis / np.linalg.norm(axis), np.array(self.local(look.point))
        ends = [(origin + s * axis).tolist() for s in (low - margin, high + margin)]
        shape = {"kind": "line", "from": ends[0], "to": ends[1]}
        self.shapes[look.point.body.display_name].append(shape)

    @draw.register
    def _(self, look: Path, element: Any) -> None:
        u = ca.SX.sym("u")
        where = self.widened(look.position(u))
        place = ca.Function("path", [u, self.parameters], [where])
        samples = np.linspace(*look.interval, CURVE_SAMPLES)[None, :]
        parameters = np.tile(self.motion.parameters[:, None], CURVE_SAMPLES)
        points = place.map(CURVE_SAMPLES)(samples, parameters).full().T.tolist()
        shape = {"kind": "curve", "points": points, "closed": bool(look.closed)}
        self.shapes[look.body.display_name].append(shape)

    @draw.register
    def _(self, look: Link, element: Any) -> None:
        ends = {"i": self.place(look.point_i), "j": self.place(look.point_j)}
        self.links.append(named(look, element) | ends)

    @draw.register
    def _(self, look: Contact, element: Any) -> None:
        described = named(look, element) | {"body": "ground", "point": [0.0] * self.dimension}
        self.joints.append(described | {"grounded": False} | self.reaction(element))
        self.later.append((self.joints[-1], self.components("at", look.place), look.place))

    @draw.register
    def _(self, look: Arrow, element: Any) -> None:
        self.load("force", self.widened(look.force), named(look, element) | self.place(look.point))

    @draw.register
    def _(self, look: Twist, element: Any) -> None:
        pivot = self.pivots.between(None, look.body)
        self.load("moment", self.moment(look.moment), named(look, element) | self.place(pivot))

    def load(self, name: str, vector: ca.SX, described: Place) -> None:
        """An applied force or moment, over time."""
        if self.loads:
            self.symbols.append(described)
            self.later.append((described, self.components(name, vector), vector))

    def wheels(self, look: Belt) -> tuple[list[Place], bool]:
        """The wheels of a belt, by radii in its ratio, and whether it is crossed."""
        pivots = [self.pivots.between(look.carrier, b) for b in (look.body_i, look.body_j)]
        ratio, (p, q) = self.size_of(look.ratio), [self.start(pivot) for pivot in pivots]
        unit = 0.3 * float(np.linalg.norm(p - q)) / (abs(ratio) + 1)
        found = [
            self.seat(pivot) | {"radius": unit * turns}
            for pivot, turns in zip(pivots, (abs(ratio), 1.0), strict=True)
        ]
        return found, ratio < 0

    def start(self, point: Point) -> np.ndarray:
        """Where a point is at the first instant."""
        if point.body.name == "ground":
            return np.array(self.local(point))
        return np.atleast_1d(self.motion.values(self.widened_place(point))[self.keep[0]])

    def widened_place(self, point: Point) -> Expression:
        """Its position, in as many components as the drawing has."""
        return Expression(self.widened(point.position.sx))

    def seat(self, point: Point) -> Place:
        """A point, with all that pages read of how it stands."""
        return self.place(point)

    def moment(self, sx: ca.SX) -> ca.SX:
        """A moment, about as many axes as the drawing has to turn about."""
        return sx

    def reaction(self, joint: Any) -> dict[str, list[float]]:
        """Columns of the force and moment that the joint bears."""
        if joint.name not in self.data.labels("joint"):
            return {}
        force, moment = (
            self.data.at(f"reaction_{k}", joint=joint.name)[self.keep] for k in ("force", "moment")
        )
        if not np.isfinite(force).any():
            return {}
        lever = 1e-9 * self.size * np.nanmax(np.abs(force))
        moment = np.where(np.abs(moment) > lever, moment, 0.0)
        found: dict[str, list[float]] = {}
        for name, table in (("force", force), ("moment", moment.reshape(len(self.keep), -1))):
            columns = self.components(name, ca.SX(table.shape[1], 1))
            found |= dict(zip(columns, table.T.tolist(), strict=True))
        return found


def named(look: Look, element: Any) -> dict[str, Any]:
    """Name of the element, what it is in words, and the symbol of the primitive."""
    what = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(element).__name__).lower()
    return {"name": element.name, "what": what, "symbol": type(look).__name__.lower()}


def ends_of(point: Point, base: Point | BodyElement) -> tuple[str, str]:
    """Names of the bodies that a mark stands on."""
    return point.body.name, base.body.name if isinstance(base, Point) else base.name


def held(bodies: tuple[str, str]) -> str:
    """Of the names of two bodies, that of one that is not the ground."""
    return bodies[1] if bodies[0] == "ground" else bodies[0]
