"""Forms of shapes in collisions: rounded hulls, cylinders, terrain and concave boundaries."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.curves import Curve
from dalembert.symbolic.rotation import across

MARKS = 8
"""Points on the rim of each end of a cylinder, on which the end stands."""


@dataclass(frozen=True, eq=False)
class Hull:
    """All points within a distance of the convex hull of corners.

    A ball has one corner, a capsule two, a polygon or a box has the radius zero. A cylinder has the
    ends of its axis, then ``MARKS`` points on the rim of each end.

    Attributes
    ----------
    corners : positions in the axes of the body; of a polygon anticlockwise
    radius : [m]
    edges : numbers of their corners; those of planar hulls have the material on their left
    faces : numbers of their corners, anticlockwise from outside; spatial hulls only
    parallel : groups of edges of equal direction for all parameters; none by default
    flat_ends : whether it is a cylinder of the radius about its edge
    grid : numbers of rows and columns of a terrain, whose material is below its faces; its first
        three corners are that of the grid at height zero, and one cell farther along x and y
    """

    corners: tuple[ca.SX, ...]
    radius: ca.SX
    edges: tuple[tuple[int, int], ...] = ()
    faces: tuple[tuple[int, ...], ...] = ()
    parallel: tuple[tuple[int, ...], ...] = ()
    flat_ends: bool = False
    grid: tuple[int, int] | None = None

    @property
    def parallel_edges(self) -> tuple[tuple[int, ...], ...]:
        """Groups of all edges by their directions."""
        return self.parallel or tuple((k,) for k in range(len(self.edges)))

    @cached_property
    def is_sharp(self) -> bool:
        """Whether its corners and edges are sharp."""
        return self.flat_ends or bool(self.radius.is_zero())

    @classmethod
    def planar(cls, corners: list[ca.SX], radius: ca.SX) -> Hull:
        """The hull of planar corners; a capsule has two edges with opposite normals."""
        n = len(corners)
        edges = tuple((k, (k + 1) % n) for k in range(n)) if n > 1 else ()
        return cls(tuple(corners), radius, edges)

    @classmethod
    def cylinder(cls, ends: tuple[ca.SX, ca.SX], radius: ca.SX) -> Hull:
        """The cylinder about the line between two ends."""
        axis = (ends[0] - ends[1]) / ca.norm_2(ends[0] - ends[1])
        side = across(axis)[:, 0]
        angles = 2 * np.pi / MARKS * np.arange(MARKS)
        marks = [
            end
            + radius * (float(np.cos(angle)) * side + float(np.sin(angle)) * ca.cross(out, side))
            for end, out in ((ends[0], axis), (ends[1], -axis))
            for angle in angles
        ]
        return cls((*ends, *marks), radius, ((0, 1),), flat_ends=True)


@dataclass(frozen=True, eq=False)
class Solid:
    """A convex part of a shape.

    Attributes
    ----------
    carrier : the body, or the part of a beam, that it moves with
    hull : its form in the axes of the carrier
    """

    carrier: Any
    hull: Hull


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
