"""Joints with play: a round body in a hole that is a little larger."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Rate, Scalar, quantity
from dalembert.elements.contact.contact import Touching
from dalembert.elements.contact.shapes import Hollow, Round, Shape
from dalembert.elements.pair import BetweenPoints
from dalembert.symbolic.formulas.expression import Expression


@dataclass(eq=False)
class ClearanceJoint(Touching, BetweenPoints):
    """A journal in a bearing, or a ball in a socket, with play: contact where a joint would be.

    The gap is ``g = clearance − |r_j − r_i|``; inside it the bodies are free.

    Parameters
    ----------
    point_i : middle of the hole in the first body
    point_j : middle of what is in it, of the second body
    radius : of what is in it [m]
    clearance : by how much the hole has a larger radius [m]
    """

    radius: Scalar = quantity("m", "radius of journal or ball", above=0.0, keyword=True)
    clearance: Scalar = quantity("m", "radius of the hole less that", minimum=0.0, keyword=True)
    hole: ClassVar[type[Hollow]]
    inside: ClassVar[type[Round]]

    @cached_property
    def _shapes(self) -> tuple[Shape, Shape]:
        wide = Expression(self.radius.sx + self.clearance.sx)
        return self.hole(self.point_i, wide), self.inside(self.point_j, self.radius)

    @property
    def shapes(self) -> tuple[Shape, Shape]:
        return self._shapes

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        away = {"eccentricity": (self.between, "m"), "distance": (self.distance, "m")}
        return {**super().measures(rate), **away}
