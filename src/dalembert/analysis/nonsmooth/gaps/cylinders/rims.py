"""Contact points of the rim of a cylinder, as formulas.

The angles of the nearest points of a rim and a line, or of two rims, are roots of equations without
a closed form. Newton's method starts from a direction near the root.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.analysis.nonsmooth.gaps.cylinders.cylinders import LEVEL, SLANTED
from dalembert.elements.contact.contact_point import (
    ContactPoint,
    contact_at_wall,
    contact_of_balls,
)

ITERATIONS = 8
"""Newton iterations of an angle."""
LARGEST = 0.3
"""Upper limit of a step of an angle [rad]."""


@dataclass(frozen=True, eq=False)
class Rim:
    """Rim of an end of a cylinder.

    Attributes
    ----------
    center, outward, radius : circle about an axis
    side : unit vector normal to the axis, from which angles are measured
    start : angle near the contact point
    """

    center: ca.SX
    outward: ca.SX
    radius: ca.SX
    side: ca.SX
    start: ca.SX

    @classmethod
    def of(cls, points: list[ca.SX], radius: ca.SX) -> Rim:
        """The rim of the ends of the axis and, optionally, a point on it and a start direction."""
        axis = points[0] - points[1]
        outward = axis / ca.norm_2(axis)
        if len(points) == 2:
            return cls(points[0], outward, radius, ca.SX.zeros(3), ca.SX(0))
        side = (points[2] - points[0]) / radius
        return cls(points[0], outward, radius, side, ca.atan2(points[3][1], points[3][0]))

    def at(self, angle: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Point at an angle, its unit vector from the centre, and the tangent."""
        other = ca.cross(self.outward, self.side)
        away = ca.cos(angle) * self.side + ca.sin(angle) * other
        tangent = ca.cos(angle) * other - ca.sin(angle) * self.side
        return self.center + self.radius * away, away, tangent


def contact_with_plane(point: ca.SX, normal: ca.SX, rim: Rim) -> ContactPoint:
    """The point of a rim farthest against a normal; one of a rim parallel to the plane."""
    across = normal - ca.dot(normal, rim.outward) * rim.outward
    other = ca.if_else(ca.fabs(rim.outward[0]) < SLANTED, ca.SX([1, 0, 0]), ca.SX([0, 1, 0]))
    level = other - ca.dot(other, rim.outward) * rim.outward
    across = ca.if_else(ca.sumsqr(across) > LEVEL**2, across, level)
    across /= ca.norm_2(across)
    across -= ca.dot(across, rim.outward) * rim.outward  # rounding, of a rim parallel to the plane
    lowest = rim.center - rim.radius * across
    return contact_at_wall(point, normal, lowest, ca.SX(0))


def contact_with_corner(rim: Rim, corner: ca.SX, radius: ca.SX) -> ContactPoint:
    """The point of a rim nearest to a rounded corner."""
    relative = corner - rim.center
    across = relative - ca.dot(relative, rim.outward) * rim.outward
    nearest = rim.center + rim.radius * across / ca.norm_2(across)
    return contact_of_balls(nearest, ca.SX(0), corner, radius)


def contact_with_line(rim: Rim, ends: list[ca.SX], radius: ca.SX) -> ContactPoint:
    """The point of a rim nearest to a line with a radius."""
    place, foot, *_ = _nearest_of_line(rim, ends)
    return contact_of_balls(place, ca.SX(0), foot, radius)


def contact_with_edge(rim: Rim, ends: list[ca.SX]) -> ContactPoint:
    """Contact of a rim and a sharp edge, along their common normal."""
    place, foot, along, away, tangent = _nearest_of_line(rim, ends)
    normal = _outside(ca.cross(tangent, along), rim.outward + away)
    return _along(normal, place, foot)


def contact_of_rims(first: Rim, second: Rim) -> ContactPoint:
    """Contact of two rims, along their common normal."""
    i, j = first.start, second.start
    for _ in range(ITERATIONS):
        (p, away, t), (q, other_away, s) = first.at(i), second.at(j)
        between, both = q - p, ca.dot(t, s)
        own, other = ca.dot(between, t), ca.dot(between, s)
        a = -first.radius - ca.dot(between, away)
        d = second.radius - ca.dot(between, other_away)
        b, c = second.radius * both, -first.radius * both
        determinant = a * d - b * c
        i -= _limited((d * own - b * other) / determinant)
        j -= _limited((a * other - c * own) / determinant)
    (p, away, t), (q, other_away, s) = first.at(i), second.at(j)
    outside = first.outward + away - second.outward - other_away
    return _along(_outside(ca.cross(t, s), outside), p, q)


def _nearest_of_line(rim: Rim, ends: list[ca.SX]) -> tuple[ca.SX, ...]:
    """Nearest points of a rim and a line, direction of the line, away and tangent of the rim."""
    along = (ends[1] - ends[0]) / ca.norm_2(ends[1] - ends[0])
    angle = rim.start
    for _ in range(ITERATIONS):
        place, away, tangent = rim.at(angle)
        relative = place - ends[0]
        across = relative - ca.dot(relative, along) * along
        slope = rim.radius * (1 - ca.dot(tangent, along) ** 2) - ca.dot(across, away)
        angle -= _limited(ca.dot(tangent, across) / slope)
    place, away, tangent = rim.at(angle)
    foot = ends[0] + ca.dot(place - ends[0], along) * along
    return place, foot, along, away, tangent


def _limited(step: ca.SX) -> ca.SX:
    return ca.fmin(LARGEST, ca.fmax(-LARGEST, step))


def _outside(across: ca.SX, outside: ca.SX) -> ca.SX:
    """The unit vector along ``across`` that points outside."""
    sign = ca.if_else(ca.dot(across, outside) < 0, -1, 1)
    return sign * across / ca.norm_2(across)


def _along(normal: ca.SX, place: ca.SX, other: ca.SX) -> ContactPoint:
    gap = ca.dot(normal, other - place)
    return ContactPoint(gap, normal, place + gap / 2 * normal)
