"""Round and straight shapes of the plane."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look, Vector, quantity
from dalembert.elements.contact.shapes import Flat, Hollow, Round
from dalembert.elements.look import Disc
from dalembert.elements.rotation import unit


@dataclass(eq=False)
class Circle(Round):
    """Disc of the plane."""

    space = 2

    def look(self, near: ca.SX) -> list[Look]:
        return [Disc(self.point, self.radius.sx)]


@dataclass(eq=False)
class Bore(Hollow):
    """Round hole of the plane, with what touches it inside."""

    space = 2

    def look(self, near: ca.SX) -> list[Look]:
        return [Disc(self.point, self.radius.sx)]


@dataclass(eq=False)
class HalfPlane(Flat):
    """Matter on one side of a straight line of the plane.

    Parameters
    ----------
    point : point of a body on the line
    normal : (2,) out of the matter, in the axes of the body
    """

    space = 2
    normal: Vector = quantity("", "out of the matter, in body axes", default=(0.0, 1.0), size=2)

    @property
    def outward(self) -> ca.SX:
        return self.carrier.turned(unit(self.normal.sx, "HalfPlane.normal"))

    @property
    def along(self) -> list[ca.SX]:
        x, y = ca.vertsplit(unit(self.normal.sx, "HalfPlane.normal"))
        return [ca.vertcat(y, -x)]
