"""MechanismScene of a spatial mechanism.

A primitive with an axis shows the z axis of its frame; a point of a planar body shows the normal
of the plane. Other points have no axis.
"""

from __future__ import annotations

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
from dalembert.elements.spatial.shape import Cuboid, Drum, Orb, Pill, Round, Surface
from dalembert.results.pictures.mechanism_scene import MechanismScene
from dalembert.results.pictures.primitives import Primitives
from dalembert.symbolic.rotation import EULER_PARAMETERS

ROUND = {Drum: "cylinder", Pill: "capsule"}


class SpatialPrimitives(Primitives):
    """Primitives by solids and symbols about axes."""

    dimension = 3

    def axis(self, point: Point) -> list[float] | None:
        if isinstance(point, Frame):
            return self.number(point.local_axes[:, 2]).tolist()
        return None if point.body.dimension == 3 else [0.0, 0.0, 1.0]

    # primitives ------------------------------------------------------------------------
    @singledispatchmethod
    def draw(self, look: Look, element: Element) -> None:
        super().draw(look, element)

    @draw.register
    def _(self, look: Cuboid, element: Element) -> None:
        shape = {"center": self.local(look.center), "size": self.number(look.size).tolist()}
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
        corners = self.size_of(look.scale) * look.corners
        shape = {"vertices": corners.ravel().tolist(), "faces": look.triangles.ravel().tolist()}
        self.shapes[look.body.display_name].append({"kind": "mesh", **shape})

    @draw.register
    def _(self, look: Block, element: Element) -> None:
        axis = self.number(self.padded(look.direction)).tolist()
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
        def at(quantity: str) -> np.ndarray:
            return self.data.at(quantity, body=body.name)[self.keep]

        position, rotation = at("position"), np.full((len(self.keep), 4), np.nan)
        if "euler_parameters" in self.data:
            rotation = at("euler_parameters")
        if not body.rotates:
            rotation = np.tile([1.0, 0.0, 0.0, 0.0], (len(self.keep), 1))
        elif body.dimension == 2:
            half_angle = at("angle") / 2
            rotation = np.stack(
                [np.cos(half_angle), 0 * half_angle, 0 * half_angle, np.sin(half_angle)], axis=1
            )
        return self.pose(position, rotation)

    def pose(self, position: np.ndarray, rotation: np.ndarray) -> dict[str, list[float]]:
        if position.shape[1] == 2:  # planar motion
            half_angle, zeros = rotation / 2, np.zeros(len(rotation))
            position = np.column_stack([position, zeros])
            rotation = np.column_stack([np.cos(half_angle), zeros, zeros, np.sin(half_angle)])
        columns = [*position.T, *rotation.T]
        return dict(zip((*AXES, *EULER_PARAMETERS), (c.tolist() for c in columns), strict=True))

    def outline(self, body: BodyElement) -> None:
        """Draw the body by its own look, else by its points and inertia."""
        looks, shapes = body.look(), self.primitives.shapes[body.name]
        for look in looks:
            self.primitives.draw(look, body)
        if looks:
            return
        no_shapes = not shapes
        center, points = self.center(body), [np.array(p) for p in self.points[body.name]]
        distant = [p for p in points if np.linalg.norm(p - center) > 1e-6 * self.size]
        if len(points) > 2 and self.flat(points):
            shapes.append({"kind": "plate", "points": [p.tolist() for p in points]})
        elif len(points) > 1 and self.flat([*points, center], 1):
            first, last = _ends(points)
            shapes.append({"kind": "bar", "from": first.tolist(), "to": last.tolist()})
            ellipsoid = self.inertia_ellipsoid(body, center)
            thickness = sorted(ellipsoid.get("size", [0.0, 0.0]))[-2]
            if no_shapes and thickness > MIN_THICKNESS * np.linalg.norm(last - first):
                shapes.append(ellipsoid)
        else:
            for p in distant:
                shapes.append({"kind": "bar", "from": center.tolist(), "to": p.tolist()})
            if no_shapes:
                shapes.append(self.inertia_ellipsoid(body, center))

    def center(self, body: BodyElement) -> np.ndarray:
        """The mass centre in the body frame."""
        return (
            self.primitives.number(body.center_of_mass.sx)
            if isinstance(body, Body)
            else np.zeros(3)
        )

    def flat(self, points: list[np.ndarray], dimension: int = 2) -> bool:
        """Whether points span exactly a plane (2) or a line (1)."""
        spread = np.linalg.svd(np.array(points) - np.mean(points, axis=0), compute_uv=False)
        rank = int((spread > 1e-6 * self.size).sum())
        return rank == dimension

    def inertia_ellipsoid(self, body: BodyElement, center: np.ndarray) -> dict[str, Any]:
        """Solid ellipsoid with the inertia of a body; a ball if there is none."""
        mass = self.primitives.size_of(body.mass.sx)
        if not (isinstance(body, Body) and body.rotates and mass > 0):
            return {"kind": "particle", "center": center.tolist()}
        moments, axes = np.linalg.eigh(
            self.primitives.number(tensor(body.inertia.sx)).reshape(3, 3)
        )
        squares = 2.5 * (moments.sum() - 2 * moments) / mass
        radii = np.sqrt(np.maximum(squares, (MIN_RADIUS * self.size) ** 2))
        radii *= min(1.0, MAX_RADIUS * self.size / radii.max())
        if np.linalg.det(axes) < 0:
            axes[:, 0] *= -1
        from scipy.spatial.transform import Rotation

        quaternion = Rotation.from_matrix(axes).as_quat(scalar_first=True)
        shape = {"kind": "ellipsoid", "center": center.tolist(), "size": (2 * radii).tolist()}
        return shape | {"turn": quaternion.tolist()}


def _ends(points: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """End points of collinear points."""
    coordinates = [float((p - points[0]) @ (points[1] - points[0])) for p in points]
    return points[int(np.argmin(coordinates))], points[int(np.argmax(coordinates))]
