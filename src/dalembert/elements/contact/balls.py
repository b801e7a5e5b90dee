"""Where balls meet each other and walls: gap, normal and place, and the velocity there."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.contact.meeting import tangents


@dataclass(frozen=True, eq=False)
class BallMeeting:
    """Two things near each other, in space; in the plane everything has the third coordinate 0.

    Attributes
    ----------
    distance : ``g`` [m]
    normal : (3,) from the first to the second
    place : (3,) between them
    """

    distance: ca.SX
    normal: ca.SX
    place: ca.SX

    @classmethod
    def of_balls(cls, first: ca.SX, radius: ca.SX, second: ca.SX, other: ca.SX) -> BallMeeting:
        """``g = |r_j − r_i| − R_i − R_j``."""
        way = second - first
        length = ca.norm_2(way)
        gap, normal = length - radius - other, way / length
        return cls(gap, normal, first + (radius + gap / 2) * normal)

    @classmethod
    def of_wall(cls, point: ca.SX, normal: ca.SX, center: ca.SX, radius: ca.SX) -> BallMeeting:
        """``g = n·(r − r_P) − R``."""
        gap = ca.dot(normal, center - point) - radius
        return cls(gap, normal, center - (radius + gap / 2) * normal)

    def directions(self, dimension: int) -> ca.SX:
        """(3, d) the normal, and one or two directions along the surface."""
        x, y, _ = ca.vertsplit(self.normal)
        across = ca.vertcat(-y, x, 0) if dimension == 2 else tangents(self.normal)
        return ca.horzcat(self.normal, across)

    def speed(self, dimension: int, first: tuple, second: tuple) -> ca.SX:
        """(d,) relative velocity where they meet, of second to first.

        Both are given by a place on them, its velocity and the angular velocity.
        """
        velocities = [v + ca.cross(w, self.place - r) for r, v, w in (first, second)]
        return ca.mtimes(self.directions(dimension).T, velocities[1] - velocities[0])
