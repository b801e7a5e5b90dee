"""Planar capsules."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.contact.hull import Hull
from dalembert.elements.contact.rounded_line import RoundedLine
from dalembert.elements.look import Path


@dataclass(eq=False)
class Capsule(RoundedLine):
    """All points within a distance of the line between two points of a planar body.

    Parameters
    ----------
    point_i, point_j : points of one body
    radius : [m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("rod", gravity=(0, -10))
    >>> rod = system.add(planar.Bar("rod", length=0.4, mass=4.0, position=(0, 0.0499)))
    >>> shape, floor = contact.Capsule(rod.start, rod.end, 0.05), contact.HalfPlane(system.ground)
    >>> law = contact.KelvinVoigt(stiffness=1e5)
    >>> touch = system.add(planar.Contact("touch", floor, shape, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["rod.y"].item(), 6)  # the radius minus m g/(2 k)
    0.0498
    """

    space = 2

    def hull(self) -> Hull:
        return Hull.planar([self.point_i.local.sx, self.point_j.local.sx], self.radius.sx)

    def look(self, near: ca.SX) -> list[Look]:
        return [Path(self.carrier, self._outline, (0.0, 4.0), True)]

    def _outline(self, u: ca.SX) -> ca.SX:
        """Position on the outline: a side, the arc about an end, the other side, the other arc."""
        start, axis = self.point_i.local.sx, self.point_j.local.sx - self.point_i.local.sx
        along, first_arc, back, last_arc = (ca.fmin(1, ca.fmax(0, u - k)) for k in range(4))
        angle = ca.pi * (first_arc + last_arc - 0.5)
        x, y = ca.vertsplit(axis / ca.norm_2(axis))
        c, s = ca.cos(angle), ca.sin(angle)
        outward = ca.vertcat(c * x - s * y, c * y + s * x)
        return start + (along - back) * axis + self.radius.sx * outward
