"""Base classes of shapes about the line between two points: capsules and cylinders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.base import Scalar, option, quantity
from dalembert.elements.contact.shapes import NO_LENGTH, Ball, Shape, Spot, Spotted
from dalembert.elements.pair import need_point
from dalembert.elements.point import Point
from dalembert.errors import ModelError


@dataclass(eq=False)
class AboutLine(Shape):
    """A body of revolution about the line between two points of a body.

    Parameters
    ----------
    point_i, point_j : points of one body
    radius : [m]
    """

    point_i: Point = option("one end of its axis")
    point_j: Point = option("the other end, of the same body")
    radius: Scalar = quantity("m", "radius", above=0.0)
    feels = (Ball,)

    def __post_init__(self) -> None:
        name = type(self).__name__
        self.point_i = need_point(self.point_i, name, "point_i", self.space)
        self.point_j = need_point(self.point_j, name, "point_j", self.space)
        bodies = self.point_i.body, self.point_j.body
        if bodies[0] is not bodies[1]:
            names = " and ".join(body.name for body in bodies)
            raise ModelError(f"its ends are on {names}; give two points of one body", name)
        super().__post_init__()

    @property
    def carrier(self) -> Any:
        return self.point_i.body

    @property
    def dimension(self) -> int:
        return self.point_i.dimension


@dataclass(eq=False)
class RoundedLine(Spotted, AboutLine):
    """All points within a distance of the line between two points of a body."""

    def spots(self) -> list[Spot]:
        return [Spot(end, self.radius.sx) for end in (self.point_i, self.point_j)]

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        start, end = self.point_i.position.sx, self.point_j.position.sx
        axis, relative = end - start, place - start
        fraction = ca.fmin(1, ca.fmax(0, ca.dot(axis, relative) / (ca.sumsqr(axis) + NO_LENGTH**2)))
        return ca.sqrt(ca.sumsqr(relative - fraction * axis) + NO_LENGTH**2) - self.radius.sx
