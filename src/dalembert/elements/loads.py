"""What applied loads of the plane and of space share: a force at a point, a moment on a body."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import ForceElement, Look, Powers, Rate
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Arrow, Motor, Twist
from dalembert.elements.pair import need_body, need_point, refuse_same_body
from dalembert.elements.point import Point
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression


@dataclass(eq=False)
class PointForce(ForceElement):
    """Force at a point; its components are inertial or those of a body."""

    point: Point
    vector: Expression

    def __post_init__(self) -> None:
        self.point = need_point(self.point, self.name, "point")
        super().__post_init__()

    def axes(self) -> BodyElement | None:
        """The body whose axes the components are in; None if they are inertial."""
        raise NotImplementedError

    def components(self) -> ca.SX:
        """In inertial axes."""
        return in_inertial_axes(self.vector.sx, self.axes())

    def powers(self, rate: Rate) -> Powers:
        return [(rate(self.point.position.sx), self.components())]

    def look(self) -> list[Look]:
        return [Arrow(self.point, self.components())]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        return {"force": (self.components(), "N")}

    def parts(self) -> list[Coordinates]:
        return known_once([self.point.body, self.axes()])


class Couple(ForceElement):
    """Moment on a body, with its reaction on a second one if given."""

    name: str
    body: BodyElement
    reaction_on: BodyElement | None
    measured = "moment"

    def __post_init__(self) -> None:
        self.body = need_body(self.body, self.name, "body")
        if self.reaction_on is not None:
            self.reaction_on = need_body(self.reaction_on, self.name, "reaction_on")
            refuse_same_body(self.body, self.reaction_on, self.name)
        for body in (self.body, self.reaction_on):
            if body is not None and not body.rotates:
                raise ModelError(f"{body.name} is a particle; a moment cannot act on it", self.name)
        super().__post_init__()

    @property
    def turning(self) -> ca.SX:
        """(3,) angular velocity of the body against what carries the reaction."""
        carried = self.reaction_on
        return self.body.turning - (carried.turning if carried is not None else 0)

    def components(self) -> ca.SX:
        """(3,) the moment in inertial axes."""
        raise NotImplementedError

    def powers(self, rate: Rate) -> Powers:
        return [(self.turning, self.components())]

    def look(self) -> list[Look]:
        motor = [] if self.reaction_on is None else [Motor(self.reaction_on, self.body)]
        return [*motor, Twist(self.body, self.components())]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        moment = self.components()
        return {
            self.measured: (moment, "N m"),
            "power": (ca.dot(moment, self.turning), "W"),
        }

    def parts(self) -> list[Coordinates]:
        return known_once([self.body, self.reaction_on])


def in_inertial_axes(vector: ca.SX, body: BodyElement | None) -> ca.SX:
    """Components of a vector that are in the axes of a body, or inertial if there is none."""
    return vector if body is None else body.turned(vector)


def known_once(bodies: list[BodyElement | None]) -> list[Coordinates]:
    """The bodies there are, each once."""
    return list(dict.fromkeys(body for body in bodies if body is not None))
