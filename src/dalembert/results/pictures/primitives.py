"""Primitives of a mechanism as plain data, common to plane and space."""

from __future__ import annotations

import re
from functools import singledispatchmethod
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Element, Look
from dalembert.elements.body import BodyElement
from dalembert.elements.look import (
    Arrow,
    Ball,
    Belt,
    Contact,
    Disc,
    Limit,
    Link,
    Mark,
    Mesh,
    Path,
    Rail,
    Rotary,
    Segment,
    Travel,
    Twist,
)
from dalembert.elements.point import Point
from dalembert.results.pictures.collector import SceneCollector
from dalembert.results.sources import numbers

CURVE_SAMPLES = 181
NORMAL = [0.0, 0.0, 1.0]
"""Axis of a disc without an axis of its own."""


class Primitives(SceneCollector):
    """Collector of primitives; subclasses add those of the plane or of space."""

    @singledispatchmethod
    def draw(self, look: Look, element: Element) -> None:
        """Record the data of a primitive of an element."""
        raise NotImplementedError(f"{type(look).__name__} has no drawing")

    @draw.register
    def _(self, look: Segment, element: Element) -> None:
        ends = {"from": self.local(look.point_i), "to": self.local(look.point_j)}
        self.shapes[look.point_i.body.display_name].insert(0, {"kind": "bar", **ends})

    @draw.register
    def _(self, look: Ball, element: Element) -> None:
        shape = {"kind": "particle", "center": self.local(look.point)}
        self.shapes[look.point.body.display_name].append(shape)

    @draw.register
    def _(self, look: Rail, element: Element) -> None:
        (low, high), margin = self.limits(look.travel), 0.12 * self.size
        axis, origin = self.padded(look.direction), self.padded(look.point.local.sx)
        axis = axis / ca.norm_2(axis)
        ends = [self.number(origin + s * axis) for s in (low - margin, high + margin)]
        shape = {"kind": "line", "from": ends[0], "to": ends[1]}
        self.shapes[look.point.body.display_name].append(shape)

    @draw.register
    def _(self, look: Path, element: Element) -> None:
        u = ca.SX.sym("u")
        position = self.padded(look.position(u))
        curve = ca.Function("path", [u, self.parameters], [position])
        samples = np.linspace(*look.interval, CURVE_SAMPLES)[None, :]
        parameters = np.tile(self.motion.parameters[:, None], CURVE_SAMPLES)
        values = curve.map(CURVE_SAMPLES)(samples, parameters).full().T
        points = values.tolist()
        if ca.depends_on(position, self.parameters):
            columns = [curve(ca.SX(s), self.parameters) for s in samples.ravel()]
            points = [numbers(row, sx) for row, sx in zip(values, columns, strict=True)]
        shape = {"kind": "curve", "points": points, "closed": bool(look.closed)}
        self.shapes[look.body.display_name].append(shape)

    @draw.register
    def _(self, look: Link, element: Element) -> None:
        ends = {"i": self.point_data(look.point_i), "j": self.point_data(look.point_j)}
        self.links.append(symbol_header(look, element) | ends)

    @draw.register
    def _(self, look: Disc, element: Element) -> None:
        shape: dict[str, Any] = {"kind": "disc", "center": self.local(look.point)}
        shape |= {"radius": self.size_of(look.radius), "axis": self.axis(look.point) or NORMAL}
        self.shapes[look.point.body.display_name].append(shape)

    @draw.register
    def _(self, look: Mark, element: Element) -> None:
        bodies, ends = body_names(look.point, look.base), [self.anchor(look.point)]
        if isinstance(look.base, Point):
            ends.append(self.anchor(look.base))
            if bodies[0] == "ground":
                ends.reverse()
        symbol = symbol_header(look, element) | ends[0] | {"grounded": "ground" in bodies}
        symbol |= {"on": moving_body(bodies)} | ({"base": ends[1]} if len(ends) > 1 else {})
        self.joints.append(symbol | self.reaction(element))

    @draw.register
    def _(self, look: Mesh, element: Element) -> None:
        symbol = symbol_header(look, element) | self.anchor(look.point) | {"grounded": False}
        symbol["mesh"] = [
            self.anchor(p) | {"radius": self.size_of(r)}
            for p, r in ((look.point, look.radius), (look.base, look.base_radius))
            if isinstance(p, Point)
        ]
        self.joints.append(symbol | {"internal": look.internal} | self.reaction(element))

    @draw.register
    def _(self, look: Rotary, element: Element) -> None:
        pivot = self.pivots.between(look.body_i, look.body_j)
        ends = [b.name if b is not None else "ground" for b in (look.body_i, look.body_j)]
        symbol = symbol_header(look, element) | self.anchor(pivot)
        self.symbols.append(symbol | dict(zip("ij", ends, strict=True)))

    @draw.register
    def _(self, look: Belt, element: Element) -> None:
        wheels, crossed = self.wheels(look)
        symbol = symbol_header(look, element) | {"wheels": wheels, "crossed": crossed}
        self.joints.append(symbol | wheels[1] | {"grounded": False} | self.reaction(element))

    @draw.register
    def _(self, look: Travel, element: Element) -> None:
        on = look.body.name if look.body is not None else "ground"
        axis = self.number(self.padded(look.direction))
        symbol = symbol_header(look, element) | self.point_data(look.point)
        self.symbols.append(symbol | {"on": on, "axis": axis})

    @draw.register
    def _(self, look: Limit, element: Element) -> None:
        """A wall at the limit; for a rotation in space, a mark on its axis."""
        moving = [b for b in self.model.bodies if ca.jacobian(look.coordinate, b.pose).nnz()]
        if not (moving and self.loads):
            return
        reach = {
            name: shape["width"] / 2
            for name, shapes in self.shapes.items()
            for shape in shapes
            if "width" in shape
        }
        wall = self.pivots.wall(look, self.model.bodies, reach)
        pivot = self.pivots.between(moving[0] if len(moving) > 1 else None, moving[-1])
        origin = {"body": "ground", "point": [0.0] * self.dimension}
        symbol = symbol_header(look, element) | (self.anchor(pivot) if wall is None else origin)
        self.symbols.append(symbol)
        if wall is not None:
            parts = [self.padded(part) for part in ca.vertsplit(wall, wall.numel() // 2)]
            for name, part in zip(("at", "normal"), parts, strict=True):
                self.time_dependent.append((symbol, self.components(name, part), part))

    @draw.register
    def _(self, look: Contact, element: Element) -> None:
        symbol = symbol_header(look, element) | {"body": "ground", "point": [0.0] * self.dimension}
        self.joints.append(symbol | {"grounded": False} | self.reaction(element))
        self.time_dependent.append((self.joints[-1], self.components("at", look.place), look.place))

    @draw.register
    def _(self, look: Arrow, element: Element) -> None:
        self.load(
            "force",
            self.padded(look.force),
            symbol_header(look, element) | self.point_data(look.point),
        )

    @draw.register
    def _(self, look: Twist, element: Element) -> None:
        pivot = self.pivots.between(None, look.body)
        self.load(
            "moment",
            self.moment(look.moment),
            symbol_header(look, element) | self.point_data(pivot),
        )


def symbol_header(look: Look, element: Element) -> dict[str, Any]:
    """Name and type of the element, and the symbol of the primitive."""
    description = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(element).__name__).lower()
    return {"name": element.name, "description": description, "symbol": type(look).__name__.lower()}


def body_names(point: Point, base: Point | BodyElement) -> tuple[str, str]:
    """Names of the bodies of a mark."""
    return point.body.name, base.body.name if isinstance(base, Point) else base.name


def moving_body(bodies: tuple[str, str]) -> str:
    """The first of two body names that is not the ground."""
    return bodies[1] if bodies[0] == "ground" else bodies[0]
