"""Geometry of links in URDF files, for pictures."""

from __future__ import annotations

import numpy as np

from dalembert.errors import FileError
from dalembert.io.imports.robots.parts import Shape
from dalembert.io.imports.robots.pose import Pose, roll_pitch_yaw
from dalembert.io.imports.robots.reader import Omissions, mesh_shape
from dalembert.io.imports.xml.element import XmlElement
from dalembert.io.imports.xml.resources import Resources


class UrdfShapes:
    """Reader of ``<visual>`` elements, or of ``<collision>`` of a link without these.

    Parameters
    ----------
    resources : lookup of meshes
    omissions : collects geometry that cannot be drawn
    """

    def __init__(self, resources: Resources, omissions: Omissions):
        self.resources, self.omissions = resources, omissions

    def of_link(self, link: XmlElement) -> list[Shape]:
        elements = link.all("visual") or link.all("collision")
        shapes = []
        for element in elements:
            element.ignore("name")
            place, geometry = element.only("origin"), element.only("geometry")
            pose = Pose()
            if place is not None:
                xyz = np.array(place.numbers("xyz", 3, default=(0.0, 0.0, 0.0)))
                rpy = place.numbers("rpy", 3, default=(0.0, 0.0, 0.0))
                pose = Pose(xyz, roll_pitch_yaw(*rpy))
            shape = None if geometry is None else self.shape(geometry, pose)
            if shape is not None:
                shapes.append(shape)
        return shapes

    def shape(self, geometry: XmlElement, pose: Pose) -> Shape | None:
        """The first shape of a geometry."""
        for element in geometry.all("box", "sphere", "cylinder", "capsule", "mesh"):
            if element.tag == "box":
                return Shape("Box", pose, {"size": element.numbers("size", 3)})
            if element.tag == "sphere":
                return Shape("Sphere", pose, {"radius": element.number("radius")})
            if element.tag == "mesh":
                return self.mesh(element, pose)
            sizes = {key: element.number(key) for key in ("radius", "length")}
            return Shape(element.tag.title(), pose, sizes)
        return None

    def mesh(self, element: XmlElement, pose: Pose) -> Shape | None:
        """A mesh, if its file exists and can be drawn."""
        reference = element.text("filename")
        scale = element.numbers("scale", 1, 3, default=(1.0, 1.0, 1.0))
        try:
            file = self.resources.find(reference)
        except FileError as error:
            self.omissions.add_file(element, "mesh", reference, error)
            return None
        return mesh_shape(file, scale, pose, element, self.omissions)
