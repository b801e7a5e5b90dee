"""Links of SDF: inertia and geometry."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.errors import FileError
from dalembert.io.imports.robots.inertia import Inertia
from dalembert.io.imports.robots.parts import Shape
from dalembert.io.imports.robots.pose import Pose
from dalembert.io.imports.robots.reader import Omissions, mesh_shape
from dalembert.io.imports.robots.sdf.frames import local_pose
from dalembert.io.imports.robots.sdf.values import number, text
from dalembert.io.imports.xml.element import XmlElement
from dalembert.io.imports.xml.resources import Resources

SIZES = {"sphere": ("radius",), "cylinder": ("radius", "length"), "capsule": ("radius", "length")}
MOMENTS = {
    **{"ixx": (0, 0, 1.0), "iyy": (1, 1, 1.0), "izz": (2, 2, 1.0)},
    **{"ixy": (0, 1, 0.0), "ixz": (0, 2, 0.0), "iyz": (1, 2, 0.0)},
}
"""Element → row, column and default of the inertia tensor."""


def link_inertia(link: XmlElement) -> Inertia:
    """Inertia of a link in its frame; 1 kg and 1 kg m² by default, as the format states."""
    element = link.only("inertial")
    if element is None:
        return Inertia(1.0, np.zeros(3), np.eye(3))
    if element.has("auto") and element.flag("auto", False):
        raise element.error(
            "auto: masses from the geometry are not computed; write <mass> and <inertia>"
        )
    mass = number(element, "mass", 1.0)
    if mass < 0:
        raise element.error(f"the mass is {mass:g} kg; it is not negative")
    table, tensor = element.only("inertia"), np.zeros((3, 3))
    for name, (i, j, default) in MOMENTS.items():
        tensor[i, j] = tensor[j, i] = number(table, name, default)
    return Inertia(mass, np.zeros(3), tensor).seen_from(local_pose(element.only("pose")))


class SdfShapes:
    """Reader of ``<visual>`` elements, or of ``<collision>`` of a link without these.

    Parameters
    ----------
    resources : lookup of meshes
    omissions : collects geometry that cannot be drawn
    """

    def __init__(self, resources: Resources, omissions: Omissions):
        self.resources, self.omissions = resources, omissions

    def of_link(self, link: XmlElement) -> list[Shape]:
        shapes = []
        for element in link.all("visual") or link.all("collision"):
            element.ignore("name")
            geometry = element.only("geometry")
            pose = local_pose(element.only("pose"))
            shape = None if geometry is None else self.shape(geometry, pose)
            if shape is not None:
                shapes.append(shape)
        return shapes

    def shape(self, geometry: XmlElement, pose: Pose) -> Shape | None:
        for element in geometry.all("box", "ellipsoid", "mesh", *SIZES):
            sizes: dict[str, Any]
            if element.tag == "mesh":
                return self.mesh(element, pose)
            if element.tag == "box":
                sizes = {"size": element.needed("size").content_numbers(3)}
            elif element.tag == "ellipsoid":
                radii = element.needed("radii").content_numbers(3)
                sizes = {"size": [2 * radius for radius in radii]}
            else:
                sizes = {key: number(element, key) for key in SIZES[element.tag]}
            return Shape(element.tag.title(), pose, sizes)
        return None

    def mesh(self, element: XmlElement, pose: Pose) -> Shape | None:
        reference, scale = text(element, "uri"), element.only("scale")
        factors = [1.0] * 3 if scale is None else scale.content_numbers(3)
        try:
            file = self.resources.find(reference)
        except FileError as error:
            self.omissions.add_file(element, "mesh", reference, error)
            return None
        return mesh_shape(file, factors, pose, element, self.omissions)
