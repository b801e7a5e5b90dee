"""Planar polygons with dents."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Condition, Look, Rows, option
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.hull import Boundary, Solid
from dalembert.elements.contact.shapes import Ball, Shape
from dalembert.elements.look import Path
from dalembert.elements.pair import need_body
from dalembert.elements.planar.contact.polygon import (
    checked_vertices,
    outline,
    sides_of,
    without_straight,
)

FAR = 1e300
"""Distance from a side of places that are beyond its ends [m]."""


@dataclass(eq=False)
class Outline(Shape):
    """Planar polygon that may have dents.

    In a ``Contact``, a ball touches the nearest side or corner; in ``Collisions`` other shapes
    touch all sides within reach.

    Parameters
    ----------
    body : the body it is fixed in
    vertices : (x, y) of its corners in the body frame, anticlockwise around its material [m];
        formulas are allowed

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("ball in a groove", gravity=(0, -10))
    >>> ball = system.add(planar.Body("ball", mass=1.0, inertia=0.005, position=(0.02, 0.17)))
    >>> groove = [(-1, -0.5), (1, -0.5), (1, 1), (0, 0), (-1, 1)]
    >>> shapes = [contact.Outline(system.ground, groove), contact.Circle(ball, 0.1)]
    >>> hits = system.add(planar.Collisions("hits", shapes, friction=0.5))
    >>> motion = da.solve_nonsmooth(system.build(), 1.0, step=5e-3)
    >>> motion["ball.position"][-1].values.round(6) + 0.0  # it touches both sides
    array([0.      , 0.141421])
    """

    body: BodyElement = option("the body it is fixed in")
    vertices: Rows = option("corners (x, y) in the body frame, anticlockwise around its material")
    feels = (Ball,)
    space = 2

    def __post_init__(self) -> None:
        self.body = need_body(self.body, "Outline", "body")
        self.vertices = checked_vertices(self.vertices, "Outline")
        super().__post_init__()

    @property
    def carrier(self) -> Any:
        return self.body

    @property
    def corners(self) -> tuple[ca.SX, ...]:
        """Its corners in the axes of the body, without those between sides in one line."""
        return tuple(without_straight([vertex.sx for vertex in self.vertices]))

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        nearest, signed = ca.SX(FAR), ca.SX(FAR)
        sides = sides_of(self.local(place), self.corners)
        turns = zip(self.corners[-1:] + self.corners[:-1], self.corners, strict=True)
        edges = [corner - before for before, corner in turns]  # ending at each corner
        for k, side in enumerate(sides):
            inside = ca.logic_not(ca.logic_or(side.before_start, side.beyond_end))
            at_start = ca.logic_and(sides[k - 1].beyond_end, side.before_start)
            following = edges[(k + 1) % len(edges)]
            convex = _cross(edges[k], following) > 0
            outside = side.from_start
            if sharp:  # a lower bound without the singular direction at the corner
                outside = ca.fmax(sides[k - 1].height, side.height)
            at_corner = ca.if_else(convex, outside, -side.from_start)
            for size, value in (
                (ca.if_else(inside, ca.fabs(side.height), FAR), side.height),
                (ca.if_else(at_start, side.from_start, FAR), at_corner),
            ):
                signed = ca.if_else(size < nearest, value, signed)
                nearest = ca.fmin(nearest, size)
        return signed

    def boundary(self) -> Boundary:
        return Boundary(vertices=self.corners)

    def solids(self) -> list[Solid]:
        return [Solid(self.body, corner) for corner in self.boundary().corners()]

    def look(self, near: ca.SX) -> list[Look]:
        corners = ca.horzcat(*self.corners)
        return [Path(self.body, lambda u: outline(corners, u), (0.0, corners.shape[1]), True)]

    def conditions(self) -> list[Condition]:
        corners = ca.horzcat(*self.corners)
        following = ca.horzcat(corners[:, 1:], corners[:, 0])
        conditions = [*super().conditions()]
        area = ca.sum2(_cross(corners, following))
        conditions.append((area, "its vertices run clockwise; give them anticlockwise"))
        if (disjoint := _disjoint(corners, following)).numel():
            crossing = "its edges cross each other; give the vertices in their order"
            conditions.append((disjoint, crossing))
        return conditions


def _cross(a: ca.SX, b: ca.SX) -> ca.SX:
    """(1, n) cross products of the columns."""
    return a[0, :] * b[1, :] - a[1, :] * b[0, :]


def _disjoint(corners: ca.SX, following: ca.SX) -> ca.SX:
    """Not negative where two edges that have no corner in common do not cross, of all pairs."""
    count = corners.shape[1]
    first, second = np.triu_indices(count, 2)
    apart = second - first < count - 1
    pairs = first[apart].tolist(), second[apart].tolist()

    def sides(edge: list[int], other: list[int]) -> ca.SX:
        """Negative where the ends of the other edge are on different sides of an edge."""
        start, along = corners[:, edge], (following - corners)[:, edge]
        ends = corners[:, other], following[:, other]
        return _cross(along, ends[0] - start) * _cross(along, ends[1] - start)

    low, high = ca.fmin(corners, following), ca.fmax(corners, following)
    between = [low[:, edge] - high[:, other] for edge, other in (pairs, pairs[::-1])]
    boxes = ca.vertcat(*between)  # some positive: apart, also on one line but for rounding
    separated = ca.fmax(ca.fmax(boxes[0, :], boxes[1, :]), ca.fmax(boxes[2, :], boxes[3, :]))
    return ca.fmax(separated, ca.fmax(sides(*pairs), sides(*pairs[::-1]))).T
