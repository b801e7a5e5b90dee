"""Applied loads: gravity, a force at a point, a moment on a body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Element, ForceElement, Look, Powers, Rate
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Arrow, Motor, Twist
from dalembert.elements.pair import need_body, need_point, refuse_same_body
from dalembert.elements.point import Point
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression, stack


class Gravity(ForceElement):
    """Uniform field that acts on all masses; the system adds it for its ``gravity``."""

    conservative = True

    def __init__(self, vector: Expression, elements: Sequence[Element]):
        self.name = "gravity"
        self.vector, self.elements = vector, elements

    def _weights(self) -> tuple[ca.SX, ca.SX]:
        """Positions of all masses and their weights."""
        field, positions, weights = self.vector.sx, [], []
        for position, mass in (pair for element in self.elements for pair in element.masses()):
            n = min(position.numel(), field.numel())
            positions.append(position[:n])
            weights.append(mass * field[:n])
        return stack(positions), stack(weights)

    def potential(self) -> ca.SX:
        return -ca.dot(*self._weights())

    def powers(self, rate: Rate) -> Powers:
        positions, weights = self._weights()
        return [(rate(positions), weights)]


@dataclass(eq=False)
class PointForce(ForceElement):
    """Force at a point; its components are in inertial axes or in those of a body."""

    point: Point
    vector: Expression

    def __post_init__(self) -> None:
        self.point = need_point(self.point, self.name, "point")
        super().__post_init__()

    def axes(self) -> BodyElement | None:
        """The body in whose axes the components are stated; None for inertial axes."""
        raise NotImplementedError

    def components(self) -> ca.SX:
        """The force in inertial axes."""
        return in_inertial_axes(self.vector.sx, self.axes())

    def powers(self, rate: Rate) -> Powers:
        return [(rate(self.point.position.sx), self.components())]

    def look(self) -> list[Look]:
        return [Arrow(self.point, self.components())]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        return {"force": (self.components(), "N")}

    def parts(self) -> list[Coordinates]:
        return distinct([self.point.body, self.axes()])


class Couple(ForceElement):
    """Moment on a body, with its reaction on an optional second one."""

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
        """(3,) angular velocity relative to the body that carries the reaction."""
        reaction = self.reaction_on
        return self.body.turning - (reaction.turning if reaction is not None else 0)

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
        return distinct([self.body, self.reaction_on])


def in_inertial_axes(vector: ca.SX, body: BodyElement | None) -> ca.SX:
    """Inertial components of a vector stated in the axes of a body; unchanged without a body."""
    return vector if body is None else body.turned(vector)


def distinct(bodies: list[BodyElement | None]) -> list[Coordinates]:
    """The bodies without None and duplicates."""
    return list(dict.fromkeys(body for body in bodies if body is not None))
