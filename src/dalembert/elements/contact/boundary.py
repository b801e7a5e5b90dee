"""Boundaries of planar shapes that may be concave: the form of these shapes in collisions."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.contact.hull import Hull
from dalembert.elements.curves import Curve


@dataclass(frozen=True, eq=False)
class Boundary:
    """A curve in the axes of a body, with the material on its left.

    Attributes
    ----------
    curve : a curve; None for a polygon
    vertices : of a polygon, anticlockwise around its material
    tips : convex corners of a curve, which is smooth between them
    """

    curve: Curve | None = None
    vertices: tuple[ca.SX, ...] = ()
    tips: tuple[ca.SX, ...] = ()

    def corners(self) -> list[Hull]:
        """Tips, ends of an open curve, or vertices of a polygon, as hulls of one corner."""
        places = [*self.vertices, *self.tips]
        if self.curve is not None and not self.curve.closed:
            places += [self.curve.position(ca.SX(end)) for end in self.curve.interval()]
        return [Hull((place,), ca.SX(0)) for place in places]
