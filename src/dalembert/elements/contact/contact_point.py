"""Contact points of two shapes, of balls, and of a ball and a wall."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca

from dalembert.elements.base import Constraint
from dalembert.symbolic.rotation import across

VelocityAt = Callable[[ca.SX], ca.SX]
"""(3,) velocity of a body at an inertial position (3,)."""


@dataclass(frozen=True, eq=False)
class ContactPoint:
    """A potential contact point of two bodies.

    Attributes
    ----------
    distance : gap, positive while separated [m]
    normal : unit vector from the first body to the second, inertial components
    place : position halfway between the two surfaces
    foot : equations that determine it on a curve, or None
    bodies : the first and the second body, or cross-section of a beam, whose materials touch
    weight : 1, or the fraction of the length that a station of a line represents
    """

    distance: ca.SX
    normal: ca.SX
    place: ca.SX
    foot: Constraint | None = None
    bodies: tuple[Any, Any] | None = None
    weight: float = 1.0

    def reversed(self) -> ContactPoint:
        """The contact point with the bodies exchanged."""
        bodies = self.bodies and self.bodies[::-1]
        return replace(self, normal=-self.normal, bodies=bodies)

    @property
    def directions(self) -> ca.SX:
        """(n, n) the normal and the tangents as columns."""
        n = self.normal
        return ca.horzcat(n, ca.vertcat(n[1], -n[0]) if n.numel() == 2 else across(n))

    def speeds(self, at_i: VelocityAt, at_j: VelocityAt) -> ca.SX:
        """(n,) velocity of the second body relative to the first, along the directions."""
        n = self.normal.numel()
        place = ca.vertcat(self.place, ca.SX.zeros(3 - n))
        return ca.mtimes(self.directions.T, (at_j(place) - at_i(place))[:n])

    def surface_speeds(self, at_i: VelocityAt, at_j: VelocityAt, gap: ca.SX) -> ca.SX:
        """(n,) as ``speeds``, of a point of each body, a gap apart, halfway around the place.

        Fixed steps apply an impact while the bodies are apart. At its instant they are not: the
        levers of friction are those of the surfaces.
        """
        n, half = self.normal.numel(), gap / 2 * self.normal
        none = ca.SX.zeros(3 - n)
        here, there = (ca.vertcat(self.place + side, none) for side in (-half, half))
        return ca.mtimes(self.directions.T, (at_j(there) - at_i(here))[:n])

    def turning(self, of_i: ca.SX, of_j: ca.SX) -> ca.SX:
        """(1,) or (3,) angular velocity (3,) of the second body relative to the first: in the
        plane; in space about the tangents, then about the normal."""
        relative = of_j - of_i
        if self.normal.numel() == 2:
            return relative[2]
        directions = self.directions
        return ca.mtimes(ca.horzcat(directions[:, 1:], directions[:, 0]).T, relative)

    @property
    def slip(self) -> ca.SX:
        """(1,) or (2,) velocity of the second body along the surface of the first."""
        at_i, at_j = (body.velocity_at for body in self.bodies or ())
        return self.speeds(at_i, at_j)[1:]

    @property
    def surface_slip(self) -> ca.SX:
        """(1,) or (2,) as ``slip``, of the surfaces, which a gap may separate."""
        at_i, at_j = (body.velocity_at for body in self.bodies or ())
        return self.surface_speeds(at_i, at_j, self.distance)[1:]


def contact_of_balls(
    center_i: ca.SX, radius_i: ca.SX, center_j: ca.SX, radius_j: ca.SX
) -> ContactPoint:
    """``g = |r_j − r_i| − R_i − R_j``."""
    between = center_j - center_i
    length = ca.norm_2(between)
    gap, normal = length - radius_i - radius_j, between / length
    return ContactPoint(gap, normal, center_i + (radius_i + gap / 2) * normal)


def contact_at_wall(point: ca.SX, normal: ca.SX, center: ca.SX, radius: ca.SX) -> ContactPoint:
    """``g = n·(r − r_P) − R``."""
    gap = ca.dot(normal, center - point) - radius
    return ContactPoint(gap, normal, center - (radius + gap / 2) * normal)
