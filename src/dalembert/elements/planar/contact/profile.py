"""Curved contact profiles: cams with rollers, points and flat followers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Condition, Constraint, Look, option
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.contact_point import ContactPoint
from dalembert.elements.contact.hull import Boundary, Solid
from dalembert.elements.contact.shapes import Ball, Flat, Shape, Spot
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.curves import Curve
from dalembert.elements.look import Path
from dalembert.elements.pair import need_body
from dalembert.errors import ModelError

SAMPLES, CLOSED = 9, 1e-6
"""Number of points at which a curve is verified, and distance of the ends of a closed one relative
to its size [-]."""


@dataclass(eq=False)
class Profile(Shape):
    """A smooth curve fixed in a planar body, with the material on its left.

    The parameter of the point nearest to another shape, and its distance, are massless coordinates;
    assembly finds the nearest point, which is then followed. The radius of curvature of a concave
    curve must exceed that of the other shape; a straight line can touch convex curves only. In
    ``Collisions`` there are no such coordinates: all near points of other shapes touch, at several
    places of a concave curve, and the ends of an open curve are corners.

    Parameters
    ----------
    body : the body it is fixed in
    curve : in the frame of the body; anticlockwise around its material

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("rocker", gravity=(0, -10))
    >>> egg = system.add(planar.Body("egg", mass=1.0, inertia=0.01, position=(0, 0.0999)))
    >>> oval = da.FormulaCurve(0.2 * da.cos(da.curves.u), 0.1 * da.sin(da.curves.u))
    >>> floor = contact.HalfPlane(system.ground.center)
    >>> law = contact.KelvinVoigt(stiffness=1e5)
    >>> touch = planar.Contact("touch", floor, contact.Profile(egg, oval), law=law)
    >>> contact = system.add(touch)
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["egg.y"].item(), 6)  # half the minor axis minus m g/k
    0.0999
    """

    body: BodyElement = option("the body it is fixed in")
    curve: Curve = option("the curve, anticlockwise around its matter", default=None)
    feels = (Ball, Flat)
    space = 2

    def __post_init__(self) -> None:
        self.body = need_body(self.body, "Profile", "body")
        if not isinstance(self.curve, Curve) or self.curve.dimension != 2:
            raise ModelError(f"curve must be a planar curve, got {self.curve!r}", "Profile")
        super().__post_init__()

    @property
    def carrier(self) -> Any:
        return self.body

    def conditions(self) -> list[Condition]:
        """The curve has a length and finite points, and a closed one closes."""
        u = np.linspace(*self.curve.interval(), SAMPLES)
        points = ca.horzcat(*(self.curve.position(ca.SX(value)) for value in u))
        x, y = ca.vertsplit(points)
        size = ca.fmax(ca.mmax(x) - ca.mmin(x), ca.mmax(y) - ca.mmin(y))
        finite = ca.fabs(ca.sum2(x + y)) < np.inf
        text = "its curve is a point, or has points that are not finite"
        conditions: list[Condition] = [(ca.if_else(ca.logic_and(finite, size > 0), 1, -1), text)]
        if self.curve.closed:
            gap = ca.norm_2(points[:, -1] - points[:, 0])
            text = "the ends of its closed curve are {} m apart; close it, or give closed=False"
            conditions.append((CLOSED * size - gap, text, gap))
        return conditions

    def boundary(self) -> Boundary:
        return Boundary(self.curve)

    def solids(self) -> list[Solid]:
        return [Solid(self.body, corner) for corner in self.boundary().corners()]

    def look(self, near: ca.SX) -> list[Look]:
        curve = self.curve
        return [Path(self.body, curve.position, curve.interval(), curve.closed)]

    def contact_points(self, other: Shape, owner: str) -> list[ContactPoint]:
        if isinstance(other, Flat):
            return [Tangency(f"{owner}_foot", self, other).contact_point()]
        return [Foot(f"{owner}_foot", self, spot).contact_point() for spot in other.spots()]


class NearestPoint(Coordinates):
    """Massless coordinates: curve parameter and distance of the nearest point."""

    def __init__(self, name: str, curve: Curve):
        self.name, self.interval = f"{name}.nearest", curve.interval()
        self.make_symbols(("u", "distance"), ("", "m"))


@dataclass(eq=False)
class NearestPointEquations(Constraint):
    """Equations of the point of a curve nearest to another shape."""

    profile: Profile

    def __post_init__(self) -> None:
        self.nearest = NearestPoint(self.name, self.profile.curve)
        self.u, self.distance = ca.vertsplit(self.nearest.pose)
        super().__post_init__()

    def own_coordinates(self) -> list[Coordinates]:
        return [self.nearest]

    @property
    def position(self) -> ca.SX:
        """Inertial position of the nearest point."""
        return self.profile.body.locate(self.profile.curve.position(self.u))

    @property
    def outward(self) -> ca.SX:
        """Normal of the curve at the nearest point, inertial components."""
        curve = self.profile.curve
        return self.profile.body.turned(
            curve.offset_position(self.u, ca.SX(1)) - curve.position(self.u)
        )


@dataclass(eq=False)
class Foot(NearestPointEquations):
    """Foot of the perpendicular from a point, ``A_iᵀ (r_P − r_i) − c(u) − g n(u) = 0``."""

    spot: Spot

    def parts(self) -> list[Coordinates]:
        return [self.profile.body, *self.spot.point.body.parts(), self.nearest]

    def residual(self) -> ca.SX:
        place = self.profile.local(self.spot.point.position.sx)
        return place - self.profile.curve.offset_position(self.u, self.distance)

    def contact_point(self) -> ContactPoint:
        gap, spot = self.distance - self.spot.radius, self.spot
        bodies = self.profile.body, spot.point.body
        middle = self.position + self.outward * gap / 2
        return ContactPoint(gap, self.outward, middle, self, bodies, spot.weight)


@dataclass(eq=False)
class Tangency(NearestPointEquations):
    """Tangent point of curve and line, ``nᵀ (r_c(u) − r_P) − g = 0``, ``nᵀ r_c'(u) = 0``."""

    flat: Flat

    def parts(self) -> list[Coordinates]:
        return [self.profile.body, self.flat.carrier, self.nearest]

    def residual(self) -> ca.SX:
        height = self.flat.distance(self.position, sharp=True)
        return ca.vertcat(height - self.distance, ca.jacobian(height, self.u))

    def contact_point(self) -> ContactPoint:
        normal = self.flat.outward
        place = self.position - normal * self.distance / 2
        bodies = self.profile.body, self.flat.carrier
        return ContactPoint(self.distance, -normal, place, self, bodies)
