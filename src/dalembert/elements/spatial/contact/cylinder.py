"""Cylinders with flat ends."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.contact.hull import Hull
from dalembert.elements.contact.rounded_line import AboutLine
from dalembert.elements.contact.shapes import NO_LENGTH
from dalembert.elements.spatial.shape import Drum


@dataclass(eq=False)
class Cylinder(AboutLine):
    """Cylinder with flat ends about the line between two points of a body; a short one is a disc.

    In ``Contact``, it touches balls and points.

    Parameters
    ----------
    point_i, point_j : centres of its ends, points of one body
    radius : [m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> contact = spatial.contact
    >>> system = da.System("drum", gravity=(5, 0, -8))  # as on an incline
    >>> lying = da.rotation.axis_angle((1, 0, 0), 1.5707963267948966)
    >>> drum = system.add(spatial.Cylinder("drum", radius=0.1, length=0.3, mass=4.0,
    ...     rotation=lying, position=(0, 0, 0.1)))
    >>> shapes = [contact.Cylinder(drum.point(0, 0, -0.15), drum.point(0, 0, 0.15), 0.1),
    ...     contact.HalfSpace(system.ground.frame())]
    >>> floor = system.add(spatial.Collisions("floor", shapes, friction=0.5))
    >>> motion = da.solve_nonsmooth(system.build(), 0.3, step=0.01)
    >>> round(motion["drum.vx"][-1].item(), 6)  # it rolls with 2/3 of the acceleration
    1.0
    """

    space = 3

    def hull(self) -> Hull:
        return Hull.cylinder((self.point_i.local.sx, self.point_j.local.sx), self.radius.sx)

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        start, end = self.point_i.position.sx, self.point_j.position.sx
        length = ca.norm_2(end - start)
        axis, relative = (end - start) / length, place - (start + end) / 2
        height = ca.dot(axis, relative)
        outward = ca.sqrt(ca.sumsqr(relative - height * axis) + NO_LENGTH**2)
        over, beside = ca.fabs(height) - length / 2, outward - self.radius.sx
        deepest = ca.fmax(over, beside)
        if sharp:
            return deepest
        edge = ca.sqrt(ca.fmax(over, 0) ** 2 + ca.fmax(beside, 0) ** 2 + NO_LENGTH**2)
        return ca.if_else(deepest > 0, edge, deepest)

    def look(self, near: ca.SX) -> list[Look]:
        return [Drum(self.point_i, self.point_j, self.radius.sx)]
