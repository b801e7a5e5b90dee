"""Geometry of MJCF: masses and inertias of geoms, and shapes for pictures."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from dalembert.elements.spatial.surface import read_triangles
from dalembert.errors import DalembertError
from dalembert.io.imports.robots import inertia as moments
from dalembert.io.imports.robots.inertia import Inertia
from dalembert.io.imports.robots.mesh_inertia import mesh_inertia
from dalembert.io.imports.robots.mjcf.binary_mesh import read_binary_mesh
from dalembert.io.imports.robots.mjcf.source import MjcfSource
from dalembert.io.imports.robots.parts import Shape
from dalembert.io.imports.robots.pose import Pose, axes_to_z, quaternion_axes
from dalembert.io.imports.robots.reader import mesh_shape
from dalembert.io.imports.xml.element import XmlElement

WATER = 1000.0
"""Default density [kg/m³]."""
DRAWN_GROUPS = (0, 1, 2)
"""Groups of geoms that are drawn by default; the others are for contacts."""
TYPES = ("plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf")
WITHOUT_MASS = ("plane", "hfield")


class Geom:
    """A geom of a body.

    Parameters
    ----------
    element : with its defaults
    source : MjcfSource
    meshes : name → element of a mesh
    offset : pose of the frame that contains it, in its body
    """

    def __init__(
        self,
        element: XmlElement,
        source: MjcfSource,
        meshes: dict[str, XmlElement],
        offset: Pose,
    ):
        self.element, self.source = element, source
        self.mesh: XmlElement | None = None
        default = "mesh" if element.has("mesh") else "sphere"
        self.type = element.choice("type", TYPES, default)
        element.ignore("name", "class")
        if self.type in ("mesh", "sdf") or (element.has("mesh") and self.type != "mesh"):
            name = element.text("mesh")
            if name not in meshes:
                raise element.error(f"there is no mesh {name!r} among the assets; add it")
            self.mesh = meshes[name]
        self.pose = source.pose(element)
        self.size = self._size()
        self.pose = offset @ self.pose
        self.group = element.integer("group", 0)

    def _size(self) -> np.ndarray:
        """(3,) radii, or half lengths."""
        element = self.element
        count = {"sphere": 1, "capsule": 2, "cylinder": 2}.get(self.type, 3)
        if self.mesh is not None and self.type not in ("mesh", "sdf"):
            element.ignore("size", "fromto")
            return self._fitted(self.mesh)
        if self.mesh is not None or self.type in WITHOUT_MASS:
            element.ignore("size", "fromto")
            return np.zeros(3)
        if element.has("fromto") and self.type != "sphere":
            ends = np.array(element.numbers("fromto", 6))
            along = ends[3:] - ends[:3]
            length = float(np.linalg.norm(along))
            if not length > 0:
                raise element.error("fromto has no length; give two different points")
            self.pose = Pose((ends[:3] + ends[3:]) / 2, axes_to_z(along))
            radius = ([*element.overlaid("size"), 0.0])[0]
            sizes = [radius, length / 2] if count == 2 else [radius, radius, length / 2]
        else:
            sizes = element.overlaid("size")[:count]
        if len(sizes) < count or min(sizes) <= 0:
            text = " ".join(f"{size:g}" for size in element.overlaid("size"))
            raise element.error(
                f"size is {text!r}; a {self.type} needs {count} positive number"
                f"{'s' if count > 1 else ''}"
            )
        return np.array([*sizes, 0.0, 0.0])[:3]

    def _fitted(self, mesh: XmlElement) -> np.ndarray:
        """Size of a shape whose box of equal inertia is that of a mesh, in its principal axes.

        A box with half lengths ``h`` has the moments ``I₁ = (h₂² + h₃²)/3`` per unit mass. With
        ``fitaabb``, the shape has the half lengths of the bounding box, about its middle.
        """
        _, center, gyration = self._of_mesh(mesh)
        principal, axes = np.linalg.eigh(gyration)
        principal, axes = principal[::-1], axes[:, ::-1]  # the longest axis is the last one
        axes = axes * np.sign(np.linalg.det(axes))
        if self.source.is_on("fitaabb", False):
            vertices, _ = mesh_data(mesh, self.source)
            middle, lengths = _around(self.type, (vertices - center) @ axes)
            center = center + axes @ middle
            self.pose, self.mesh = self.pose @ Pose(center, axes), None
            return lengths * self.element.number("fitscale", 1.0)
        a, b, c = np.sqrt(np.maximum(1.5 * (principal.sum() - 2 * principal), 0.0))
        radius = (a + b) / 2
        size = {
            "sphere": [(a + b + c) / 3, 0.0, 0.0],
            "capsule": [radius, max(c - radius / 2, 0.0), 0.0],
            "cylinder": [radius, c, 0.0],
        }.get(self.type, [a, b, c])
        self.pose, self.mesh = self.pose @ Pose(center, axes), None
        return np.array(size) * self.element.number("fitscale", 1.0)

    # inertia ----------------------------------------------------------------------------------
    def inertia(self) -> Inertia:
        """Inertia in the frame of the body."""
        element = self.element
        if self.type in WITHOUT_MASS:
            element.ignore("mass", "density")
            return Inertia()
        if element.has("shellinertia") and element.flag("shellinertia", False):
            raise element.error(
                "shellinertia: masses of shells are not converted; give the body an <inertial>"
            )
        volume, center, gyration = self._solid()
        mass = element.number("density", WATER) * volume
        if element.has("mass"):
            mass = element.number("mass")
        if mass < 0:
            raise element.error(f"the mass is {mass:g} kg; it is not negative")
        return Inertia(mass, center, mass * gyration).seen_from(self.pose)

    def _solid(self) -> tuple[float, np.ndarray, np.ndarray]:
        """Volume, mass centre and moments per unit mass about it."""
        a, b, c = self.size
        if self.mesh is not None:
            return self._of_mesh(self.mesh)
        if self.type == "sphere":
            volume, gyration = 4 / 3 * math.pi * a**3, moments.ellipsoid(np.full(3, a))
        elif self.type == "ellipsoid":
            volume, gyration = 4 / 3 * math.pi * a * b * c, moments.ellipsoid(self.size)
        elif self.type == "box":
            volume, gyration = 8 * a * b * c, moments.box(2 * self.size)
        elif self.type == "cylinder":
            volume, gyration = 2 * math.pi * a**2 * b, moments.cylinder(a, 2 * b)
        else:
            volume, gyration = moments.capsule_volume(a, 2 * b), moments.capsule(a, 2 * b)
        return volume, np.zeros(3), gyration

    def _of_mesh(self, mesh: XmlElement) -> tuple[float, np.ndarray, np.ndarray]:
        try:
            vertices, faces = mesh_data(mesh, self.source)
            return mesh_inertia(vertices, faces, mesh.text("inertia", "legacy"))
        except DalembertError as error:
            raise mesh.error(
                f"its mass properties are needed by {self.element.place}: {error}; give the body "
                "an <inertial>"
            ) from None

    # pictures ---------------------------------------------------------------------------------
    def shape(self) -> Shape | None:
        """Shape for pictures."""
        self.element.ignore("rgba", "material")
        if self.group not in DRAWN_GROUPS or self.type in WITHOUT_MASS:
            kind = f"of group {self.group}" if self.group not in DRAWN_GROUPS else f"a {self.type}"
            reason = f"{kind} is not drawn, and contacts are not created; add a Collisions element"
            self.source.omissions.add(self.element, "geom", reason)
            return None
        if self.type in ("mesh", "sdf"):
            return self._mesh_shape()
        a, b, _ = self.size.tolist()
        sizes: dict[str, Any] = {
            "sphere": {"radius": a},
            "box": {"size": (2 * self.size).tolist()},
            "ellipsoid": {"size": (2 * self.size).tolist()},
        }.get(self.type, {"radius": a, "length": 2 * b})
        return Shape(self.type.title(), self.pose, sizes)

    def _mesh_shape(self) -> Shape | None:
        mesh, omissions = self.mesh, self.source.omissions
        assert mesh is not None
        if not mesh.has("file"):
            omissions.add(self.element, "mesh", "only meshes in files are drawn")
            return None
        try:
            file = self.source.mesh_file(mesh)
        except DalembertError as error:
            omissions.add_file(mesh, "mesh", mesh.text("file"), error)
            return None
        scale = np.array(mesh.numbers("scale", 3, default=(1.0, 1.0, 1.0)))
        reference = reference_pose(mesh)
        if not reference.is_unturned and np.ptp(scale) > 0:
            omissions.add(mesh, "mesh", "turned and scaled by different factors is not drawn")
            return None
        inverse = reference.inverse
        pose = self.pose @ Pose(scale * inverse.place, inverse.axes)
        return mesh_shape(file, scale.tolist(), pose, mesh, omissions)


def _around(shape: str, vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middle of the bounding box of vertices, and (3,) size of the shape with its half lengths."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle = (low + high) / 2
    a, b, c = ((high - low) / 2).tolist()
    radius = max(a, b)
    size = {
        "sphere": [max(radius, c), 0.0, 0.0],
        "capsule": [radius, max(c - radius, 0.0), 0.0],
        "cylinder": [radius, c, 0.0],
    }.get(shape, [a, b, c])
    return middle, np.array(size)


def reference_pose(mesh: XmlElement) -> Pose:
    """Pose of the frame of a mesh in the coordinates of its file."""
    place = np.array(mesh.numbers("refpos", 3, default=(0.0, 0.0, 0.0)))
    quaternion = mesh.numbers("refquat", 4, default=(1.0, 0.0, 0.0, 0.0))
    return Pose(place, np.eye(3) if quaternion[1:] == [0.0] * 3 else quaternion_axes(quaternion))


def mesh_data(mesh: XmlElement, source: MjcfSource) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) vertices in the frame of the mesh, and (m, 3) faces."""
    if mesh.has("file"):
        path = source.mesh_file(mesh)
        if path.suffix.lower() == ".msh":
            vertices, faces = read_binary_mesh(path)
        else:
            vertices, faces = read_triangles(path, mesh.place)
    elif mesh.has("vertex"):
        vertices = np.reshape(mesh.numbers("vertex"), (-1, 3))
        faces = np.empty((0, 3), dtype=int)
        if mesh.has("face"):
            faces = np.reshape(np.array(mesh.numbers("face"), dtype=int), (-1, 3))
    else:
        raise mesh.error("has neither file nor vertex, and only these are read")
    reference = reference_pose(mesh)
    vertices = (vertices - reference.place) @ reference.axes
    return vertices * mesh.numbers("scale", 3, default=(1.0, 1.0, 1.0)), faces
