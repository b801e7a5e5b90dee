"""Shapes of bodies that touch: what all of them state, in the plane and in space.

A shape says where it presses on others, its *spots*, balls that fill it or its corners; or how
others press on it, by the signed distance of a place from its surface; or both. Two shapes meet by
the spots of one and the distance from the other.

To write a new one, give ``carrier``, ``spots`` if it is ``Spotted``, ``distance`` if it ``feels``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca

from dalembert.elements.base import Look, Scalar, option, quantity
from dalembert.elements.contact.meeting import Meeting
from dalembert.elements.ingredient import Ingredient
from dalembert.elements.look import Ball as Dot, Rail
from dalembert.elements.pair import need_point
from dalembert.elements.point import Point
from dalembert.errors import ModelError

NO_LENGTH = 1e-30
"""Keeps the length of nothing differentiable."""


@dataclass(frozen=True, eq=False)
class Spot:
    """A ball that stands for a shape, or for a part of it; a corner has no radius."""

    point: Point
    radius: ca.SX


@dataclass(eq=False)
class Shape(Ingredient):
    """A shape fixed in a body."""

    feels: ClassVar[tuple[type[Shape], ...]] = ()
    """Shapes that press on it: balls, or corners on what is flat."""
    mutual: ClassVar[bool] = False
    """Corners of either of two such shapes touch the other."""
    space: ClassVar[int] = 0
    """2 of the plane, 3 of space, 0 of both."""

    @property
    def carrier(self) -> Any:
        """The body it is fixed in."""
        raise NotImplementedError

    @property
    def dimension(self) -> int:
        """Of the places on it."""
        return int(self.carrier.dimension)

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        """Of an inertial place from its surface, negative inside [m].

        Of a sharp one, which has no radius and touches inside only, a smaller one will do outside.
        """
        raise NotImplementedError

    def local(self, place: ca.SX) -> ca.SX:
        """The inertial place in the axes of its body."""
        n, body = place.numel(), self.carrier
        axes = ca.horzcat(*(body.turned(ca.SX.eye(n)[:, k]) for k in range(n)))
        return ca.mtimes(axes.T, place - body.locate(ca.SX.zeros(n)))

    def meet(self, other: Shape, owner: str) -> list[Meeting]:
        """Where another shape, which it feels, may touch it; by the spots of that one."""
        return [self._felt(spot) for spot in other.spots()]

    def _felt(self, spot: Spot) -> Meeting:
        """The outward normal is the gradient of the distance."""
        place = spot.point.position.sx
        symbol = ca.SX.sym("place", place.numel())
        distance = self.distance(symbol, sharp=spot.radius.is_zero())
        outward = ca.gradient(distance, symbol)
        distance, outward = ca.substitute([distance, outward], [symbol], [place])
        gap = distance - spot.radius
        return Meeting(gap, outward, place - outward * (spot.radius + gap / 2))

    def spots(self) -> list[Spot]:
        """What presses on others."""
        raise NotImplementedError

    def look(self, near: ca.SX) -> list[Look]:
        """What pictures show of it, where it meets something at an inertial place."""
        return []


@dataclass(eq=False)
class Spotted(Shape):
    """A shape that presses by spots."""


@dataclass(eq=False)
class Pointed(Shape):
    """A shape about a point."""

    point: Point = option("where it is")

    def __post_init__(self) -> None:
        name, given = type(self).__name__, getattr(self.point, "dimension", 2)
        self.point = need_point(self.point, name, "point", max(given, self.space))
        if self.space not in (0, self.point.dimension):
            raise ModelError(
                f"its point on {self.carrier.name} has {self.point.dimension} coordinates; give it "
                f"{self.space}, or take another shape",
                name,
            )
        super().__post_init__()

    @property
    def carrier(self) -> Any:
        return self.point.body

    @property
    def dimension(self) -> int:
        return self.point.dimension

    def away(self, place: ca.SX) -> ca.SX:
        """Distance of a place from the point."""
        return ca.sqrt(ca.sumsqr(place - self.point.position.sx) + NO_LENGTH**2)


class Ball(Spotted, Pointed):
    """A shape that one spot fills."""


@dataclass(eq=False)
class Vertex(Ball):
    """A point that touches: a corner, a tip, a particle.

    Parameters
    ----------
    point : point of a body

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("tilted bar", gravity=(0, -10))
    >>> bar = system.add(planar.Bar("bar", length=1.0, mass=2.0, angle=0.3, position=(0.48, 0.148)))
    >>> floor, law = contact.HalfPlane(system.ground.center), contact.KelvinVoigt(stiffness=1e5)
    >>> left, right = contact.Vertex(bar.start), contact.Vertex(bar.end)
    >>> i = system.add(planar.Contact("i", floor, left, law=law))
    >>> j = system.add(planar.Contact("j", floor, right, law=law))
    >>> system.build().diagnosis.degrees_of_freedom  # contacts take none away
    3
    """

    def spots(self) -> list[Spot]:
        return [Spot(self.point, ca.SX(0))]

    def look(self, near: ca.SX) -> list[Look]:
        return [Dot(self.point)]


@dataclass(eq=False)
class Round(Ball):
    """All places at a distance from a point.

    Parameters
    ----------
    point : centre, point of a body
    radius : [m]
    """

    radius: Scalar = quantity("m", "radius", above=0.0)
    feels: ClassVar[tuple[type[Shape], ...]] = (Ball,)

    def spots(self) -> list[Spot]:
        return [Spot(self.point, self.radius.sx)]

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        return self.away(place) - self.radius.sx


@dataclass(eq=False)
class Hollow(Pointed):
    """What surrounds a round hole, with what touches it inside.

    Parameters
    ----------
    point : its middle, point of a body
    radius : [m]
    """

    radius: Scalar = quantity("m", "radius", above=0.0)
    feels = (Ball,)

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        return self.radius.sx - self.away(place)


class Flat(Pointed):
    """All places behind a line or plane."""

    feels = (Spotted,)

    @property
    def outward(self) -> ca.SX:
        """Unit normal out of the matter, inertial components."""
        raise NotImplementedError

    @property
    def along(self) -> list[ca.SX]:
        """Directions in it, in the axes of the body."""
        raise NotImplementedError

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        return ca.dot(self.outward, place - self.point.position.sx)

    def look(self, near: ca.SX) -> list[Look]:
        away = near - self.point.position.sx
        return [
            Rail(self.point, line, ca.dot(self.carrier.turned(line), away)) for line in self.along
        ]
