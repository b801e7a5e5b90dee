"""What bars of the plane and of space share: their ends, and what their length says of inertia."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.base import Look, Scalar
from dalembert.elements.body import BodyElement
from dalembert.elements.look import Segment
from dalembert.elements.point import Point


class SlenderBar(BodyElement):
    """Uniform bar along its x axis with the points ``start`` and ``end``, its middle the origin."""

    length: Scalar
    start: Point
    end: Point

    def slender_inertia(self, mass: ca.SX) -> ca.SX:
        """``m l²/12``, the moment across [kg m²]."""
        return mass * self.length.sx**2 / 12

    def add_ends(self) -> None:
        half = self.length / 2  # one node, so that both ends share their trigonometry
        beside = (0.0,) * (self.dimension - 1)
        self.start = self.add_point("start", (-half, *beside))
        self.end = self.add_point("end", (half, *beside))

    def look(self) -> list[Look]:
        return [Segment(self.start, self.end)]
