"""Planar convex polygons."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Condition, Look, Rows, Vector, option, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.hull import Hull
from dalembert.elements.contact.shapes import NO_LENGTH, SHORTEST, Ball, Pointed, Spot, Spotted
from dalembert.elements.look import Path
from dalembert.elements.pair import need_body
from dalembert.elements.point import Point
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression

FLAT = 1e-12
"""Dents and turns of a polygon that count as rounding, relative to its squared size [-]."""


class ConvexShape(Spotted):
    """A planar convex shape with straight edges."""

    space = 2
    mutual = True

    def corners(self) -> list[ca.SX]:
        """Its corners in the axes of the body, anticlockwise."""
        raise NotImplementedError

    def spots(self) -> list[Spot]:
        return [Spot(Point(self.carrier, corner), ca.SX(0)) for corner in self.corners()]

    def hull(self) -> Hull:
        return Hull.planar(without_straight(self.corners()), ca.SX(0))

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        corners = without_straight(self.corners())
        sides = sides_of(self.local(place), corners)
        if sharp:
            return functools.reduce(ca.fmax, [side.height for side in sides])
        deepest, distance = ca.SX(0), ca.SX(0)
        around = zip([sides[-1], *sides[:-1]], sides, [*sides[1:], sides[0]], strict=True)
        for before, side, after in around:
            at_end = ca.logic_and(side.beyond_end, after.before_start)
            at_start = ca.logic_and(before.beyond_end, side.before_start)
            nearest = ca.if_else(at_start, side.from_start, side.height)
            nearest = ca.if_else(at_end, after.from_start, nearest)
            if side is sides[0]:
                deepest, distance = side.height, nearest
            else:
                distance = ca.if_else(deepest < side.height, nearest, distance)
                deepest = ca.fmax(deepest, side.height)
        return distance

    def look(self, near: ca.SX) -> list[Look]:
        corners = ca.horzcat(*self.corners())
        return [
            Path(self.carrier, lambda u: outline(corners, u), (0.0, float(corners.shape[1])), True)
        ]


ConvexShape.feels = (Ball, ConvexShape)


def checked_vertices(vertices: Rows, owner: str) -> list[Expression]:
    """Vertices of a polygon as expressions.

    Raises
    ------
    ModelError
        No list, fewer than three vertices, or a vertex without two coordinates.
    """
    if not isinstance(vertices, (list, tuple, np.ndarray)) or len(vertices) < 3:
        raise ModelError(f"needs at least 3 vertices, got {vertices!r:.60}", owner)
    return [as_expression(v, f"{owner} vertices[{k}]", "m", 2) for k, v in enumerate(vertices)]


def without_straight(corners: Sequence[ca.SX]) -> list[ca.SX]:
    """Corners of a polygon without those between two sides in one line, if they are numbers.

    A flat face of another shape would stand on one of two such sides only.
    """
    if not all(corner.is_constant() for corner in corners):
        return list(corners)
    places = np.array([[float(corner[k]) for k in range(2)] for corner in corners])
    before, after = places - np.roll(places, 1, axis=0), np.roll(places, -1, axis=0) - places
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    straight = np.abs(turn) <= FLAT * (after**2).sum(axis=1).max()
    straight &= (before * after).sum(axis=1) > 0
    return [corner for corner, left_out in zip(corners, straight, strict=True) if not left_out]


def outline(corners: ca.SX, u: ca.SX) -> ca.SX:
    """Position on the closed line through (2, n) corners; corner ``k`` is at ``u = k``."""
    count = corners.shape[1]
    weights = [ca.fmax(0, 1 - ca.fabs(u - k)) for k in range(count + 1)]
    return ca.mtimes(corners, ca.vertcat(weights[0] + weights[count], *weights[1:count]))


def _convex(corners: list[ca.SX]) -> list[Condition]:
    """Conditions that corners are those of a convex polygon, anticlockwise.

    A polygon without right turns is convex if all triangles of its first corner are anticlockwise
    and on one side of its first edge; others go round several times, such as a pentagram.
    """
    first, following = corners[0], corners[1:] + corners[:1]
    edges = [b - a for a, b in zip(corners, following, strict=True)]
    rounding = FLAT * ca.mmax(ca.vertcat(*(ca.sumsqr(edge) for edge in edges)))
    turns = [_cross(a, b) for a, b in zip(edges, edges[1:] + edges[:1], strict=True)]
    rays = [corner - first for corner in corners[1:]]
    triangles = [_cross(a, b) for a, b in pairwise(rays)]
    sides = [_cross(rays[0], ray) for ray in rays[1:]]
    dent = "it has a dent, or edges that cross; give an Outline, or several convex polygons"
    return [
        (sum(triangles) + rounding, "its vertices run clockwise; give them anticlockwise"),
        (ca.vertcat(*turns) + rounding, dent),
        (
            ca.vertcat(*triangles, *sides) + rounding,
            "its edges cross each other; give the vertices in their order",
        ),
    ]


def _cross(a: ca.SX, b: ca.SX) -> ca.SX:
    return a[0] * b[1] - a[1] * b[0]


def _extended(corners: list[ca.SX]) -> list[Condition]:
    """Conditions that successive corners have a distance and enclose an area."""
    following = corners[1:] + corners[:1]
    edges = [ca.sumsqr(b - a) for a, b in zip(corners, following, strict=True)]
    largest = ca.mmax(ca.vertcat(*edges))
    around = zip(corners, following, strict=True)
    area = sum((a[0] * b[1] - a[1] * b[0] for a, b in around), ca.SX(0)) / 2
    return [
        (ca.vertcat(*edges) - SHORTEST**2 * largest, "two of its vertices coincide; leave one out"),
        (area - SHORTEST * largest, "its vertices enclose no area; give corners of a polygon"),
    ]


@dataclass(frozen=True, eq=False)
class Side:
    """A position relative to a side of a polygon.

    Attributes
    ----------
    height : signed distance from the line of the side, positive outside
    from_start : distance from the first corner
    before_start, beyond_end : whether its projection lies beyond either end
    """

    height: ca.SX
    from_start: ca.SX
    before_start: ca.SX
    beyond_end: ca.SX


def sides_of(place: ca.SX, corners: Sequence[ca.SX]) -> list[Side]:
    """A position relative to all sides; ends are compared by lengths along the side."""
    sides = []
    for start, end in zip(corners, [*corners[1:], corners[0]], strict=True):
        edge, relative = end - start, place - start
        direction = edge / ca.sqrt(ca.sumsqr(edge))
        away = ca.sqrt(ca.sumsqr(relative) + NO_LENGTH**2)
        beyond_end = ca.dot(direction, place - end) > 0
        before_start = ca.dot(direction, relative) < 0
        sides.append(Side(-_cross(direction, relative), away, before_start, beyond_end))
    return sides


@dataclass(eq=False)
class Polygon(ConvexShape):
    """Planar convex polygon.

    Parameters
    ----------
    body : the body it is fixed in
    vertices : (x, y) of its corners in the body frame, anticlockwise [m]; formulas are allowed

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("prism", gravity=(0, -10))
    >>> prism = system.add(planar.Body("prism", mass=3.0, inertia=0.1, position=(0, 0.0999)))
    >>> corners = [(-0.2, -0.1), (0.2, -0.1), (0, 0.2)]
    >>> shape, floor = contact.Polygon(prism, corners), contact.HalfPlane(system.ground.center)
    >>> law = contact.KelvinVoigt(stiffness=1e5)
    >>> touch = system.add(planar.Contact("touch", floor, shape, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["touch.penetration"].item() * 1e3, 6)  # m g/(2 k) [mm] on two corners
    0.15
    """

    body: BodyElement = option("the body it is fixed in")
    vertices: Rows = option("corners (x, y) in the body frame, anticlockwise")

    def __post_init__(self) -> None:
        self.body = need_body(self.body, "Polygon", "body")
        self.vertices = checked_vertices(self.vertices, "Polygon")
        super().__post_init__()

    @property
    def carrier(self) -> Any:
        return self.body

    def corners(self) -> list[ca.SX]:
        return [vertex.sx for vertex in self.vertices]

    def conditions(self) -> list[Condition]:
        corners = self.corners()
        return [*super().conditions(), *_convex(corners), *_extended(corners)]


@dataclass(eq=False)
class Rectangle(ConvexShape, Pointed):
    """Planar rectangle along the axes of its body.

    Parameters
    ----------
    point : its centre, point of a body
    size : (2,) lengths along x and y [m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("crate", gravity=(0, -10))
    >>> crate = system.add(planar.Body("crate", mass=4.0, inertia=0.1, position=(0, 0.1499)))
    >>> shape = contact.Rectangle(crate.center, (0.4, 0.3))
    >>> floor, law = contact.HalfPlane(system.ground.center), contact.KelvinVoigt(stiffness=1e5)
    >>> touch = system.add(planar.Contact("touch", floor, shape, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["crate.y"].item(), 6)  # half the height minus m g/(2 k)
    0.1498
    """

    size: Vector = quantity("m", "lengths along x and y", size=2, above=0.0)

    def corners(self) -> list[ca.SX]:
        signs = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        return [self.point.local.sx + self.size.sx * ca.SX(list(s)) / 2 for s in signs]
