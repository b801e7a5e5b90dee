"""Clearance joints: a round body in a slightly larger hole."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Rate, Scalar, quantity
from dalembert.elements.contact.contact import ShapeContact
from dalembert.elements.contact.shapes import Hollow, Round, Shape
from dalembert.elements.pair import BetweenPoints
from dalembert.symbolic.formulas.expression import Expression


@dataclass(eq=False)
class ClearanceJoint(ShapeContact, BetweenPoints):
    """A journal in a bearing, or a ball in a socket, with clearance: contact instead of a joint.

    The gap is ``g = clearance − |r_j − r_i|``; the bodies are free while it is positive.

    Parameters
    ----------
    point_i : centre of the hole in the first body
    point_j : centre of the journal or ball of the second body
    radius : of the journal or ball [m]
    clearance : radius of the hole minus that of the journal or ball [m]
    """

    radius: Scalar = quantity("m", "radius of journal or ball", above=0.0, keyword=True)
    clearance: Scalar = quantity("m", "radius of the hole less that", minimum=0.0, keyword=True)
    hole: ClassVar[type[Hollow]]
    inside: ClassVar[type[Round]]

    @cached_property
    def _shapes(self) -> tuple[Shape, Shape]:
        hole_radius = Expression(self.radius.sx + self.clearance.sx)
        return self.hole(self.point_i, hole_radius), self.inside(self.point_j, self.radius)

    @property
    def shapes(self) -> tuple[Shape, Shape]:
        return self._shapes

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        relative = {"eccentricity": (self.between, "m"), "distance": (self.distance, "m")}
        return {**super().measures(rate), **relative}
