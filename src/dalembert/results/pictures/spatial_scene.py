"""MechanismScene of a spatial mechanism.

A primitive with an axis shows the z axis of its frame; a point of a planar body shows the normal
of the plane. Other points have no axis.
"""

from __future__ import annotations

import math
from functools import singledispatchmethod
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Element, Look
from dalembert.elements.body import BodyElement
from dalembert.elements.frame import Frame
from dalembert.elements.look import Block
from dalembert.elements.point import AXES, Point
from dalembert.elements.spatial.body import Body
from dalembert.elements.spatial.inertia_tensor import tensor
from dalembert.elements.spatial.look import Cuboid, Drum, Floor, Orb, Pill, Round, Sheet, Surface
from dalembert.results.pictures.mechanism_scene import MechanismScene
from dalembert.results.pictures.primitives import Primitives
from dalembert.results.sources import InitialPicture, Track, numbers
from dalembert.symbolic.rotation import EULER_PARAMETERS

MAX_FORMULAS = 3000
"""Upper limit of coordinates of a surface with a formula each."""
ROUND = {Drum: "cylinder", Pill: "capsule"}


MARGIN = 0.12
"""Margin of a floor about the travels over it, relative to the mechanism."""


class SpatialPrimitives(Primitives):
    """Primitives by solids and symbols about axes."""

    dimension = 3

    def axis(self, point: Point) -> list[float] | None:
        if isinstance(point, Frame):
            return self.number(point.local_axes[:, 2])
        return None if point.body.dimension == 3 else [0.0, 0.0, 1.0]

    # primitives ------------------------------------------------------------------------
    @singledispatchmethod
    def draw(self, look: Look, element: Element) -> None:
        super().draw(look, element)

    @draw.register
    def _(self, look: Cuboid, element: Element) -> None:
        shape = {"center": self.local(look.center), "size": self.number(look.size)}
        self.shapes[look.center.body.display_name].append({"kind": "box", **shape})

    @draw.register
    def _(self, look: Orb, element: Element) -> None:
        shape = {"center": self.local(look.center), "radius": self.size_of(look.radius)}
        self.shapes[look.center.body.display_name].append({"kind": "sphere", **shape})

    @draw.register(Drum)
    @draw.register(Pill)
    def _(self, look: Round, element: Element) -> None:
        shape: dict[str, Any] = {"from": self.local(look.point_i), "to": self.local(look.point_j)}
        shape |= {"kind": ROUND[type(look)], "radius": self.size_of(look.radius)}
        self.shapes[look.point_i.body.display_name].append(shape)

    @draw.register
    def _(self, look: Surface, element: Element) -> None:
        vertices = (float(self.size_of(look.scale)) * look.corners).ravel()
        faces = look.triangles.ravel().tolist()
        shape: dict[str, Any] = {"kind": "mesh", "vertices": vertices.tolist(), "faces": faces}
        if not look.scale.is_constant() and vertices.size > MAX_FORMULAS:
            shape = InitialPicture(look.body.name, shape)
        elif not look.scale.is_constant():
            shape["vertices"] = numbers(vertices, look.scale * ca.DM(look.corners.ravel()))
        self.shapes[look.body.display_name].append(shape)

    @draw.register
    def _(self, look: Sheet, element: Element) -> None:
        vertices, faces = ca.vec(ca.densify(look.vertices)), look.triangles.ravel().tolist()
        shape: dict[str, Any] = {"kind": "mesh", "vertices": self.number(vertices), "faces": faces}
        if not vertices.is_constant() and vertices.numel() > MAX_FORMULAS:
            initial = [float(vertex) for vertex in shape["vertices"]]
            shape = InitialPicture(look.body.name, shape | {"vertices": initial})
        self.shapes[look.body.display_name].append(shape)

    @draw.register
    def _(self, look: Floor, element: Element) -> None:
        """A rectangle about the travels, visible from outside."""
        margin = MARGIN * self.size
        limits = [self.limits(travels.T) for travels in ca.vertsplit(look.travels)]
        (left, right), (front, back) = ((low - margin, high + margin) for low, high in limits)
        corners = ca.DM([[left, right, right, left], [front, front, back, back]])
        places = ca.mtimes(look.frame.local_axes[:, :2], corners)
        vertices = self.number(ca.repmat(look.frame.local.sx, 1, 4) + places)
        shape = {"kind": "mesh", "vertices": vertices, "faces": [0, 1, 2, 0, 2, 3]}
        self.shapes[look.frame.body.display_name].append(shape)

    @draw.register
    def _(self, look: Block, element: Element) -> None:
        axis = self.number(self.padded(look.direction))
        shape = {"kind": "block", "center": self.local(look.point), "axis": axis}
        self.shapes[look.point.body.display_name].append(shape)

    def moment(self, sx: ca.SX) -> ca.SX:
        return sx if sx.numel() == 3 else ca.vertcat(0, 0, sx)


MIN_RADIUS = 0.02
"""Lower limit of the radii of an inertia ellipsoid, relative to the mechanism."""
MAX_RADIUS = 0.2
"""Upper limit of the radii, relative to the mechanism; larger ellipsoids are scaled down."""
MIN_THICKNESS = 0.4
"""Threshold of the thickness, relative to a bar, for drawing the ellipsoid with the bar."""


class SpatialScene(MechanismScene):
    """MechanismScene by solids, or by rods and inertia ellipsoids."""

    kind = SpatialPrimitives

    def poses(self, body: BodyElement) -> dict[str, list[float]]:
        position = self.primitives.recorded("position", body=body.name)
        if not body.rotates:
            rotation = Track(np.tile([1.0, 0.0, 0.0, 0.0], (len(self.keep), 1)), None)
        elif body.dimension == 2:
            rotation = _about_z(self.primitives.recorded("angle", body=body.name))
        else:
            rotation = self.primitives.recorded("euler_parameters", body=body.name)
        return self.pose(position, rotation)

    def pose(self, position: Track, rotation: Track) -> dict[str, list[float]]:
        if position.values.shape[1] == 2:  # planar motion
            values = np.pad(position.values, ((0, 0), (0, 1)))
            sx = None if position.sx is None else ca.vertcat(position.sx, 0)
            position, rotation = Track(values, sx), _about_z(rotation)
        return position.named(AXES) | rotation.named(EULER_PARAMETERS)

    def outline(self, body: BodyElement) -> None:
        """Draw the body by its own look, else by its points and inertia."""
        looks, shapes = body.look(), self.primitives.shapes[body.name]
        for look in looks:
            self.primitives.draw(look, body)
        if looks:
            return
        no_shapes = not shapes
        center, points = self.center(body), [list(p) for p in self.points[body.name]]
        distant = [p for p in points if math.dist(p, center) > 1e-6 * self.size]
        if len(points) > 2 and self.flat(points):
            shapes.append({"kind": "plate", "points": points})
        elif len(points) > 1 and self.flat([*points, center], 1):
            first, last = _ends(points)
            shapes.append({"kind": "bar", "from": first, "to": last})
            ellipsoid = self.inertia_ellipsoid(body, center)
            thickness = sorted(ellipsoid.get("size", [0.0, 0.0]))[-2]
            if no_shapes and thickness > MIN_THICKNESS * math.dist(first, last):
                shapes.append(ellipsoid)
        else:
            for p in distant:
                shapes.append({"kind": "bar", "from": center, "to": p})
            if no_shapes:
                shapes.append(self.inertia_ellipsoid(body, center))

    def center(self, body: BodyElement) -> list[float]:
        """The mass centre in the body frame."""
        if isinstance(body, Body):
            return self.primitives.number(body.center_of_mass.sx)
        return [0.0, 0.0, 0.0]

    def flat(self, points: list[list[float]], dimension: int = 2) -> bool:
        """Whether points span exactly a plane (2) or a line (1)."""
        spread = np.linalg.svd(np.array(points) - np.mean(points, axis=0), compute_uv=False)
        rank = int((spread > 1e-6 * self.size).sum())
        return rank == dimension

    def inertia_ellipsoid(self, body: BodyElement, center: list[float]) -> dict[str, Any]:
        """Solid ellipsoid with the inertia of a body; a ball if there is none.

        Its axes have no formula: their directions, and radii about directions that depend on
        parameters, remain those of the initial ones.
        """
        mass = self.primitives.size_of(body.mass.sx)
        if not (isinstance(body, Body) and body.rotates and mass > 0):
            return {"kind": "particle", "center": center}
        inertia = tensor(body.inertia.sx)
        moments, axes = np.linalg.eigh(np.reshape(self.primitives.number(inertia), (3, 3)))
        if np.linalg.det(axes) < 0:
            axes[:, 0] *= -1
        from scipy.spatial.transform import Rotation

        quaternion = Rotation.from_matrix(axes).as_quat(scalar_first=True)
        along = ca.mtimes([ca.DM(axes).T, inertia, ca.DM(axes)])
        diagonal = np.count_nonzero(np.abs(axes) > 0) == 3  # products of inertia are zero
        principal = ca.diag(along) if diagonal else ca.DM(moments)
        squares = 2.5 * (ca.sum1(principal) - 2 * principal) / body.mass.sx
        radii = ca.sqrt(ca.fmax(squares, (MIN_RADIUS * self.size) ** 2))
        radii = radii * ca.fmin(1.0, MAX_RADIUS * self.size / ca.mmax(radii))
        size = self.primitives.number(2 * radii)
        shape = {"kind": "ellipsoid", "center": center, "size": size, "turn": quaternion.tolist()}
        if inertia.is_constant() or (diagonal and _is_diagonal(inertia)):
            return shape
        return InitialPicture(body.name, shape | {"size": [float(length) for length in size]})


def _is_diagonal(matrix: ca.SX) -> bool:
    """Whether the entries beside the diagonal are zero for all parameters."""
    return bool((matrix - ca.diag(ca.diag(matrix))).is_zero())


def _about_z(angle: Track) -> Track:
    """Euler parameters of rotations about the z axis."""
    half = angle.values[:, 0] / 2
    values = np.column_stack([np.cos(half), 0 * half, 0 * half, np.sin(half)])
    if angle.sx is None:
        return Track(values, None)
    return Track(values, ca.vertcat(ca.cos(angle.sx / 2), 0, 0, ca.sin(angle.sx / 2)))


def _ends(points: list[list[float]]) -> tuple[list[float], list[float]]:
    """End points of collinear points."""
    table = np.array(points)
    coordinates = (table - table[0]) @ (table[1] - table[0])
    return points[int(np.argmin(coordinates))], points[int(np.argmax(coordinates))]
