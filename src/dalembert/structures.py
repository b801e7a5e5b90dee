"""Finite elements, cross-sections, meshes and the builder of structures."""

from dalembert.elements.fem.attached import (
    GroundRotationSpring,
    GroundSpring,
    PointInertia,
    PointMass,
)
from dalembert.elements.fem.frame import Frame, TimoshenkoFrame
from dalembert.elements.fem.lines import AxialSpring
from dalembert.elements.fem.node import Node
from dalembert.elements.fem.plane import Quadrilateral, Quadrilateral8, Triangle, Triangle6
from dalembert.elements.fem.solid import Hexahedron, Hexahedron20, Tetrahedron, Tetrahedron10
from dalembert.elements.fem.space_frame import SpaceFrame, TimoshenkoSpaceFrame
from dalembert.elements.fem.truss import Truss
from dalembert.elements.sections import Material, Section, circle, i_section, rectangle, tube
from dalembert.model.meshes.generators import box_mesh, line_mesh, rectangle_mesh
from dalembert.model.meshes.polygon import polygon_mesh
from dalembert.model.structure import Structure
from dalembert.text.wording import no_attribute

__all__ = [
    "AxialSpring",
    "Frame",
    "GroundRotationSpring",
    "GroundSpring",
    "Hexahedron",
    "Hexahedron20",
    "Material",
    "Node",
    "PointInertia",
    "PointMass",
    "Quadrilateral",
    "Quadrilateral8",
    "Section",
    "SpaceFrame",
    "Structure",
    "Tetrahedron",
    "Tetrahedron10",
    "TimoshenkoFrame",
    "TimoshenkoSpaceFrame",
    "Triangle",
    "Triangle6",
    "Truss",
    "box_mesh",
    "circle",
    "i_section",
    "line_mesh",
    "polygon_mesh",
    "rectangle",
    "rectangle_mesh",
    "tube",
]


def __getattr__(name: str) -> object:
    if name == "ElasticStructure":
        raise AttributeError(
            "structures.ElasticStructure is replaced by System.include(name, structure, velocity=…)"
        )
    raise AttributeError(no_attribute(__name__, name, __all__))
