"""Base classes of contact shapes, planar and spatial.

A shape states its *spots*, balls or corners that touch other shapes, or the signed distance of a
position from its surface, or both. The contact of two shapes is that of the spots of one with the
surface of the other.

A new shape states ``carrier``, ``spots`` if it is ``Spotted``, ``distance`` if it ``feels``,
``hull``, or ``solids`` and ``boundary``, if it takes part in ``Collisions``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca

from dalembert.elements.base import Look, Scalar, option, quantity
from dalembert.elements.component import Component
from dalembert.elements.contact.contact_point import ContactPoint
from dalembert.elements.contact.hull import Boundary, Hull, Solid
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Ball as Dot, Rail
from dalembert.elements.pair import need_point
from dalembert.elements.point import Point
from dalembert.errors import ModelError

NO_LENGTH = 1e-30
"""Regularisation of a length at zero [m]."""
SHORTEST = 1e-9
"""Smallest length, or width, of a shape with several corners, relative to its size."""


@dataclass(frozen=True, eq=False)
class Spot:
    """A ball that represents a shape or a part of it; a corner has the radius zero.

    Attributes
    ----------
    weight : 1, or the fraction of the length that a station of a line represents
    """

    point: Point
    radius: ca.SX
    weight: float = 1.0


@dataclass(eq=False)
class Shape(Component):
    """A shape fixed in a body, or along a beam."""

    feels: ClassVar[tuple[type[Shape], ...]] = ()
    """Shapes whose spots touch its surface."""
    mutual: ClassVar[bool] = False
    """Whether the corners of either of two such shapes touch the other."""
    space: ClassVar[int] = 0
    """2 for planar, 3 for spatial shapes, 0 for both."""

    @property
    def carrier(self) -> Any:
        """The body it is fixed in, or the beam."""
        raise NotImplementedError

    @property
    def bodies(self) -> list[Coordinates]:
        """The bodies that its position depends on."""
        return [self.carrier]

    @property
    def dimension(self) -> int:
        """Number of coordinates of its points."""
        return int(self.carrier.dimension)

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        """Signed distance of an inertial position from its surface, negative inside [m].

        A ``sharp`` spot has no radius and touches inside only: a lower bound suffices outside.
        """
        raise NotImplementedError

    def local(self, place: ca.SX) -> ca.SX:
        """An inertial position in the axes of its body."""
        n, body = place.numel(), self.carrier
        axes = ca.horzcat(*(body.turned(ca.SX.eye(n)[:, k]) for k in range(n)))
        return ca.mtimes(axes.T, place - body.locate(ca.SX.zeros(n)))

    def contact_points(self, other: Shape, owner: str) -> list[ContactPoint]:
        """Potential contact points with another shape in ``feels``, one per spot of it."""
        return [self._contact_point(spot) for spot in other.spots()]

    def _contact_point(self, spot: Spot) -> ContactPoint:
        """Contact point of a spot; the outward normal is the gradient of the distance."""
        place = spot.point.position.sx
        symbol = ca.SX.sym("place", place.numel())
        distance = self.distance(symbol, sharp=spot.radius.is_zero())
        outward = ca.gradient(distance, symbol)
        distance, outward = ca.substitute([distance, outward], [symbol], [place])
        gap = distance - spot.radius
        middle = place - outward * (spot.radius + gap / 2)
        bodies = self.carrier, spot.point.body
        return ContactPoint(gap, outward, middle, bodies=bodies, weight=spot.weight)

    def spots(self) -> list[Spot]:
        """Balls or corners that touch other shapes."""
        raise NotImplementedError

    def hull(self) -> Hull | None:
        """Its form in collisions; None for shapes that are not convex or without corners."""
        return None

    def solids(self) -> list[Solid]:
        """Its convex parts in collisions."""
        hull = self.hull()
        return [] if hull is None else [Solid(self.carrier, hull)]

    def boundary(self) -> Boundary | None:
        """Its boundary in collisions, if it may be concave; corners are among the solids."""
        return None

    def look(self, near: ca.SX) -> list[Look]:
        """Primitives that represent it in pictures, given (d, m) inertial contact points."""
        return []


@dataclass(eq=False)
class Spotted(Shape):
    """A shape with spots."""


@dataclass(eq=False)
class Pointed(Shape):
    """A shape about a point."""

    point: Point = option("its position")

    def __post_init__(self) -> None:
        name, dimension = type(self).__name__, getattr(self.point, "dimension", 2)
        self.point = need_point(self.point, name, "point", max(dimension, self.space))
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
        """Distance of a position from the point."""
        return ca.sqrt(ca.sumsqr(place - self.point.position.sx) + NO_LENGTH**2)


class Ball(Spotted):
    """A shape whose spots are balls."""


@dataclass(eq=False)
class Vertex(Ball, Pointed):
    """A point: a corner, a tip, a particle.

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
    >>> system.build().diagnosis.degrees_of_freedom  # contacts remove none
    3
    """

    def spots(self) -> list[Spot]:
        return [Spot(self.point, ca.SX(0))]

    def hull(self) -> Hull:
        return Hull((self.point.local.sx,), ca.SX(0))

    def look(self, near: ca.SX) -> list[Look]:
        return [Dot(self.point)]


@dataclass(eq=False)
class Round(Ball, Pointed):
    """All points within a distance of a point.

    Parameters
    ----------
    point : centre, point of a body
    radius : [m]
    """

    radius: Scalar = quantity("m", "radius", above=0.0)
    feels: ClassVar[tuple[type[Shape], ...]] = (Ball,)

    def spots(self) -> list[Spot]:
        return [Spot(self.point, self.radius.sx)]

    def hull(self) -> Hull:
        return Hull((self.point.local.sx,), self.radius.sx)

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        return self.away(place) - self.radius.sx


@dataclass(eq=False)
class Hollow(Pointed):
    """The surroundings of a round hole, touched from inside.

    Parameters
    ----------
    point : its centre, point of a body
    radius : [m]
    """

    radius: Scalar = quantity("m", "radius", above=0.0)
    feels = (Ball,)

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        return self.radius.sx - self.away(place)


class Flat(Pointed):
    """A half-plane or half-space."""

    feels = (Spotted,)

    @property
    def outward(self) -> ca.SX:
        """Outward unit normal, inertial components."""
        raise NotImplementedError

    @property
    def along(self) -> list[ca.SX]:
        """Tangents, in the axes of the body."""
        raise NotImplementedError

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        return ca.dot(self.outward, place - self.point.position.sx)

    def look(self, near: ca.SX) -> list[Look]:
        relative = near - ca.repmat(self.point.position.sx, 1, near.shape[1])
        return [
            Rail(self.point, tangent, ca.mtimes(relative.T, self.carrier.turned(tangent)))
            for tangent in self.along
        ]
