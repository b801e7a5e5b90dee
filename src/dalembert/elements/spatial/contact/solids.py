"""Contact shapes of solids: boxes, capsules, cylinders and corners of meshes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Any

import casadi as ca

from dalembert.elements.base import Condition, Look, Vector, option, quantity
from dalembert.elements.contact.hull import Hull
from dalembert.elements.contact.rounded_line import AboutLine, RoundedLine
from dalembert.elements.contact.shapes import NO_LENGTH, SHORTEST, Ball, Pointed, Spot, Spotted
from dalembert.elements.point import Point
from dalembert.elements.spatial.contact.polyhedron import ConvexHull
from dalembert.elements.spatial.look import Cuboid, Drum, Pill, Surface
from dalembert.elements.spatial.mesh import Mesh
from dalembert.errors import ModelError

CORNERS = 200
"""Upper limit of the corners of a mesh; each is a potential contact point."""

BOX_FACES = (
    *((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1)),
    *((2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)),
)
"""Faces of a box, by corners in the order of ``spots``, anticlockwise from outside."""
BOX_EDGES = tuple((i, i + step) for step in (4, 2, 1) for i in range(8) if not i & step)
"""Edges of a box along x, y and z."""
BOX_DIRECTIONS = ((0, 1, 2, 3), (4, 5, 6, 7), (8, 9, 10, 11))
"""Parallel edges of a box."""


@dataclass(eq=False)
class Box(Spotted, Pointed):
    """Box along the axes of its body.

    Parameters
    ----------
    point : its centre, point of a body
    size : (3,) lengths along x, y and z [m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> contact = spatial.contact
    >>> system = da.System("crate", gravity=(0, 0, -10))
    >>> size = (0.4, 0.3, 0.2)
    >>> crate = system.add(spatial.Box("crate", size=size, mass=4.0, position=(0, 0, 0.0999)))
    >>> shape = contact.Box(crate.center, size)
    >>> floor, law = contact.HalfSpace(system.ground.frame()), contact.KelvinVoigt(stiffness=1e5)
    >>> touch = system.add(spatial.Contact("touch", floor, shape, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["crate.z"].item(), 6)  # half the height minus m g/(4 k)
    0.0999
    """

    space = 3
    size: Vector = quantity("m", "lengths along x, y, z", size=3, above=0.0)
    feels = (Ball,)

    def spots(self) -> list[Spot]:
        return [Spot(Point(self.carrier, corner), ca.SX(0)) for corner in self.corners()]

    def corners(self) -> tuple[ca.SX, ...]:
        """Its corners in the axes of the body."""
        middle, half = self.point.local.sx, self.size.sx / 2
        signs = (ca.SX(list(signs)) for signs in product((-1, 1), repeat=3))
        return tuple(middle + half * sign for sign in signs)

    def hull(self) -> Hull:
        return Hull(self.corners(), ca.SX(0), BOX_EDGES, BOX_FACES, BOX_DIRECTIONS)

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        heights = ca.fabs(self.local(place) - self.point.local.sx) - self.size.sx / 2
        deepest = ca.fmax(ca.fmax(heights[0], heights[1]), heights[2])
        if sharp:
            return deepest
        outside = ca.sqrt(ca.sumsqr(ca.fmax(heights, 0)) + NO_LENGTH**2)
        return ca.if_else(deepest > 0, outside, deepest)

    def look(self, near: ca.SX) -> list[Look]:
        return [Cuboid(self.point, self.size.sx)]


@dataclass(eq=False)
class Capsule(RoundedLine):
    """All points within a distance of the line between two points of a body.

    Parameters
    ----------
    point_i, point_j : points of one body
    radius : [m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> contact = spatial.contact
    >>> system = da.System("pill", gravity=(0, 0, -10))
    >>> flat = da.rotation.axis_angle((0, 1, 0), 1.5707963267948966)
    >>> pill = system.add(spatial.Capsule("pill", radius=0.1, length=0.3, mass=4.0,
    ...     rotation=flat, position=(0, 0, 0.0999)))
    >>> shape = contact.Capsule(pill.point(0, 0, -0.15), pill.point(0, 0, 0.15), 0.1)
    >>> floor, law = contact.HalfSpace(system.ground.frame()), contact.KelvinVoigt(stiffness=1e5)
    >>> touch = system.add(spatial.Contact("touch", floor, shape, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["pill.z"].item(), 6)  # the radius minus m g/(2 k)
    0.0998
    """

    space = 3

    def hull(self) -> Hull:
        ends = self.point_i.local.sx, self.point_j.local.sx
        return Hull(ends, self.radius.sx, ((0, 1),))

    def look(self, near: ca.SX) -> list[Look]:
        return [Pill(self.point_i, self.point_j, self.radius.sx)]


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

    def conditions(self) -> list[Condition]:
        ends, radius = (self.point_i.local.sx, self.point_j.local.sx), self.radius.sx
        length = ca.norm_2(ends[1] - ends[0])
        text = "its length is {} m, too small for its radius; move one of its ends"
        return [*super().conditions(), (length - SHORTEST * radius, text, length)]

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


@dataclass(eq=False)
class Corners(Spotted):
    """The corners of a mesh as contact points; in ``Collisions``, its convex hull.

    In ``Contact``, edges and faces are ignored.

    Parameters
    ----------
    body : body of a mesh

    Examples
    --------
    >>> import tempfile, trimesh
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> contact = spatial.contact
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     size = trimesh.creation.box((0.2, 0.1, 0.05)).export(f"{folder}/brick.stl")
    ...     file = f"{folder}/brick.stl"
    ...     brick = spatial.Mesh("brick", file=file, mass=2.0, position=(0, 0, 0.0249))
    >>> system = da.System("brick", gravity=(0, 0, -10))
    >>> corners = contact.Corners(system.add(brick))
    >>> floor, law = contact.HalfSpace(system.ground.frame()), contact.KelvinVoigt(stiffness=5e4)
    >>> touch = system.add(spatial.Contact("touch", floor, corners, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["brick.z"].item(), 6)  # half the height minus m g/(4 k)
    0.0249
    """

    space = 3
    body: Mesh = option("body with the form of a mesh")

    def __post_init__(self) -> None:
        if not isinstance(self.body, Mesh):
            raise ModelError(f"needs a spatial.Mesh, got {self.body!r}", "Corners")
        count = len(self.body.surface.corners)
        if count > CORNERS:
            raise ModelError(
                f"{self.body.name} has {count} corners and {CORNERS} are allowed; "
                "simplify the mesh, or use MeshHulls in Collisions, a box, capsule or sphere",
                "Corners",
            )
        super().__post_init__()

    @property
    def carrier(self) -> Any:
        return self.body

    def spots(self) -> list[Spot]:
        scale, surface = self.body.scale.sx, self.body.surface
        corners = (scale * ca.SX(list(map(float, corner))) for corner in surface.corners)
        return [Spot(Point(self.body, corner), ca.SX(0)) for corner in corners]

    def hull(self) -> Hull:
        corners, scale = self.body.surface.corners, self.body.scale.sx
        return ConvexHull.of(corners, "Corners", self.body.name).scaled(scale)

    def look(self, near: ca.SX) -> list[Look]:
        surface = self.body.surface
        return [Surface(self.body, surface.corners, surface.triangles, self.body.scale.sx)]
