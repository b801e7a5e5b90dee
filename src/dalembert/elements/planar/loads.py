"""Applied loads: point force, moment."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import (
    Coordinates,
    ForceElement,
    Powers,
    Rate,
    Scalar,
    Vector,
    option,
    quantity,
)
from dalembert.elements.pair import need_body, need_point, refuse_same_body
from dalembert.elements.planar.body import Body
from dalembert.elements.point import Point
from dalembert.errors import ModelError


@dataclass(eq=False)
class Force(ForceElement):
    """Force at a point of a body (1.53).

    Parameters
    ----------
    point : where it acts
    vector : (2,) components [N]; formulas of t, parameters and measures are allowed
    following : the components are in the body frame and turn with it; otherwise inertial
    """

    point: Point
    vector: Vector = quantity("N", "components", size=2)
    following: bool = option("components turn with the body", default=False)

    def __post_init__(self) -> None:
        self.point = need_point(self.point, self.name, "point")
        super().__post_init__()

    def components(self) -> ca.SX:
        return self.point.body.turned(self.vector.sx) if self.following else self.vector.sx

    def powers(self, rate: Rate) -> Powers:
        return [(rate(self.point.position.sx), self.components())]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        return {"force": (self.components(), "N")}

    def parts(self) -> list[Coordinates]:
        return [self.point.body]


@dataclass(eq=False)
class Moment(ForceElement):
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

    def __post_init__(self) -> None:
        self.body = need_body(self.body, self.name, "body")
        if self.reaction_on is not None:
            self.reaction_on = need_body(self.reaction_on, self.name, "reaction_on")
            refuse_same_body(self.body, self.reaction_on, self.name)
        for body in (self.body, self.reaction_on):
            if body is not None and not body.rotates:
                raise ModelError(f"{body.name} is a particle; a moment cannot act on it", self.name)
        super().__post_init__()

    def coordinate(self) -> ca.SX:
        base = self.reaction_on.pose_angle if self.reaction_on is not None else 0
        return self.body.pose_angle - base

    def powers(self, rate: Rate) -> Powers:
        return [(rate(self.coordinate()), self.value.sx)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        return {
            "moment": (self.value.sx, "N m"),
            "power": (self.value.sx * rate(self.coordinate()), "W"),
        }

    def parts(self) -> list[Coordinates]:
        return [b for b in (self.body, self.reaction_on) if b is not None]
