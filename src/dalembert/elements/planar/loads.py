"""Applied loads of the plane."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, Vector, option, quantity
from dalembert.elements.loads import Couple, PointForce
from dalembert.elements.planar.body import Body
from dalembert.elements.planar.in_plane import InPlane


@dataclass(eq=False)
class Force(InPlane, PointForce):
    """Force at a point of a body (1.53).

    Parameters
    ----------
    point : where it acts
    vector : (2,) components [N]; formulas of t, parameters and measures are allowed
    following : the components are in the body frame and turn with it; otherwise inertial
    """

    vector: Vector = quantity("N", "components", size=2)
    following: bool = option("components turn with the body", default=False)

    def axes(self) -> Body | None:
        return self.point.body if self.following else None


@dataclass(eq=False)
class Moment(InPlane, Couple):
    """Moment on a body (1.55), with its reaction on a second one if given: a rotary actuator.

    Parameters
    ----------
    body : body it acts on
    value : [N m]; formulas of t, parameters and measures are allowed
    reaction_on : body that carries the reaction; the ground if none is given
    """

    body: Body
    value: Scalar = quantity("N m", "moment")
    reaction_on: Body = option("body that carries the reaction", default=None)

    @property
    def turning(self) -> ca.SX:
        return super().turning[2]

    def components(self) -> ca.SX:
        return self.value.sx
