"""Convex polyhedra, and the convex hull of points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Look, Rows, Scalar, option, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.hull import Hull
from dalembert.elements.contact.shapes import Spot, Spotted
from dalembert.elements.pair import need_body
from dalembert.elements.planar.body import Ground
from dalembert.elements.point import Point
from dalembert.elements.spatial.look import Surface
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression

MOST = 40
"""Upper limit of the corners of a hull in collisions, of which all pairs of edges are tested."""
FLAT = 1e-6
"""Sine of the angle of triangles in one plane, whose corners may have single precision."""


@dataclass(frozen=True, eq=False)
class ConvexHull:
    """Convex hull of points in numbers.

    Attributes
    ----------
    corners : (n, 3) extreme points
    extreme : (n,) their numbers among the points
    faces : corners of each face, anticlockwise from outside
    """

    corners: np.ndarray
    extreme: np.ndarray
    faces: tuple[tuple[int, ...], ...]

    @classmethod
    def of(cls, points: np.ndarray, entity: str, name: str = "") -> ConvexHull:
        """The hull of points (m, 3), of the mesh of a body with a name.

        Raises
        ------
        ModelError
            The points lie in a plane, or the hull has too many corners.
        """
        from scipy.spatial import ConvexHull as Qhull, QhullError

        try:
            hull = Qhull(points)
        except (QhullError, ValueError):
            text = f"its {len(points)} points enclose no volume; give corners of a solid"
            raise ModelError(text, entity) from None
        if len(hull.vertices) > MOST:
            raise ModelError(
                f"{f'the convex hull of {name}' if name else 'its convex hull'} has "
                f"{len(hull.vertices)} corners and {MOST} are allowed in "
                "collisions; simplify it, use MeshHulls of a mesh, which does so, or boxes, "
                "capsules and spheres",
                entity,
            )
        extreme = np.sort(hull.vertices)
        faces = [_ordered(points, extreme, *face) for face in _planes(hull)]
        return cls(points[extreme], extreme, tuple(faces))

    @property
    def edges(self) -> tuple[tuple[int, int], ...]:
        """Pairs of corners."""
        pairs = {
            (min(i, j), max(i, j))
            for face in self.faces
            for i, j in zip(face, (*face[1:], face[0]), strict=True)
        }
        return tuple(sorted(pairs))

    @property
    def triangles(self) -> np.ndarray:
        """(k, 3) corners of triangles of the faces."""
        rows = [(f[0], f[k], f[k + 1]) for f in self.faces for k in range(1, len(f) - 1)]
        return np.array(rows)

    def scaled(self, scale: ca.SX) -> Hull:
        """The hull in lengths of the scale."""
        corners = (scale * ca.SX(list(map(float, corner))) for corner in self.corners)
        return Hull(tuple(corners), ca.SX(0), self.edges, self.faces)


def _planes(hull: Any) -> list[tuple[np.ndarray, np.ndarray]]:
    """Points of the triangles in each plane, and the outward normal."""
    normals, unassigned, planes = hull.equations[:, :3], set(range(len(hull.simplices))), []
    while unassigned:
        front = [unassigned.pop()]
        members = list(front)
        while front:
            triangle = front.pop()
            for neighbour in hull.neighbors[triangle]:
                tilt = np.linalg.norm(np.cross(normals[members[0]], normals[neighbour]))
                if neighbour in unassigned and tilt < FLAT:
                    unassigned.remove(neighbour)
                    members.append(neighbour)
                    front.append(neighbour)
        planes.append((np.unique(hull.simplices[members]), normals[members[0]]))
    return planes


def _ordered(
    points: np.ndarray, extreme: np.ndarray, face: np.ndarray, normal: np.ndarray
) -> tuple[int, ...]:
    """Numbers of the corners of a face among the extreme points, anticlockwise from outside."""
    face = face[np.isin(face, extreme)]
    relative = points[face] - points[face].mean(axis=0)
    first = relative[0] / np.linalg.norm(relative[0])
    angles = np.arctan2(relative @ np.cross(normal, first), relative @ first)
    return tuple(int(k) for k in np.searchsorted(extreme, face[np.argsort(angles)]))


@dataclass(eq=False)
class Polyhedron(Spotted):
    """Convex polyhedron; in ``Contact``, edges and faces are ignored.

    Parameters
    ----------
    body : the body it is fixed in
    vertices : (n, 3) numbers, its corners in the body frame, in units of the scale
    scale : length of their unit, which may be a formula [m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> contact = spatial.contact
    >>> system = da.System("wedge", gravity=(0, 0, -10))
    >>> corners = [(x, y, 0) for x in (-1, 1) for y in (-1, 1)] + [(-1, -1, 1), (-1, 1, 1)]
    >>> wedge = system.add(spatial.Body("wedge", mass=2.0, inertia=(0.1, 0.1, 0.1)))
    >>> shapes = [contact.Polyhedron(wedge, corners, scale=0.1),
    ...     contact.HalfSpace(system.ground.frame())]
    >>> floor = system.add(spatial.Collisions("floor", shapes))
    >>> motion = da.solve_nonsmooth(system.build(), 0.1, step=0.01)
    >>> bool(abs(motion["wedge.z"][-1]) < 1e-9)  # it stands on its face
    True
    """

    space = 3
    body: BodyElement = option("the body it is fixed in")
    vertices: Rows = option("corners (x, y, z) in the body frame, in units of the scale")
    scale: Scalar = quantity("m", "length of the unit of the vertices", default=1.0, above=0.0)

    def __post_init__(self) -> None:
        self.body = need_body(self.body, "Polyhedron", "body")
        if self.body.dimension == 2 and not isinstance(self.body, Ground):
            text = (
                f"{self.body.name} lies in a plane; give a spatial body, or planar.contact.Polygon"
            )
            raise ModelError(text, "Polyhedron")
        if not isinstance(self.vertices, (list, tuple, np.ndarray)) or len(self.vertices) < 4:
            raise ModelError(f"needs at least 4 vertices, got {self.vertices!r:.60}", "Polyhedron")
        rows = [
            as_expression(v, f"Polyhedron vertices[{k}]", "m", 3).sx
            for k, v in enumerate(self.vertices)
        ]
        if not all(row.is_constant() for row in rows):
            raise ModelError(
                "its vertices depend on parameters; give numbers, and scale= as a formula",
                "Polyhedron",
            )
        points = np.array([ca.DM(row).full().ravel() for row in rows])
        self.form = ConvexHull.of(points, "Polyhedron")
        if inner := sorted(set(range(len(points))) - set(self.form.extreme.tolist())):
            raise ModelError(
                f"vertices[{inner[0]}] is inside the others or on a face; leave it out",
                "Polyhedron",
            )
        super().__post_init__()

    @property
    def carrier(self) -> Any:
        return self.body

    @property
    def dimension(self) -> int:
        return 3

    def spots(self) -> list[Spot]:
        return [Spot(Point(self.body, corner), ca.SX(0)) for corner in self.hull().corners]

    def hull(self) -> Hull:
        return self.form.scaled(self.scale.sx)

    def look(self, near: ca.SX) -> list[Look]:
        return [Surface(self.body, self.form.corners, self.form.triangles, self.scale.sx)]
