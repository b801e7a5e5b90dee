"""Structures: nodes, elements between them, supports and loads; finite-element assembly."""

from dalembert.elements.sections import Material, Section, circle, i_section, rectangle, tube
from dalembert.structures.attached import (
    GroundRotationSpring,
    GroundSpring,
    PointInertia,
    PointMass,
)
from dalembert.structures.elastic_structure import ElasticStructure
from dalembert.structures.frame import Frame, TimoshenkoFrame
from dalembert.structures.mesh_generators import box_mesh, line_mesh, rectangle_mesh
from dalembert.structures.node import Node
from dalembert.structures.plane import Quadrilateral, Quadrilateral8, Triangle, Triangle6
from dalembert.structures.solid import Hexahedron, Hexahedron20, Tetrahedron, Tetrahedron10
from dalembert.structures.space_frame import SpaceFrame, TimoshenkoSpaceFrame
from dalembert.structures.springs import AxialSpring
from dalembert.structures.structure import Structure
from dalembert.structures.truss import Truss

__all__ = [
    "AxialSpring",
    "ElasticStructure",
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
    "rectangle",
    "rectangle_mesh",
    "tube",
]
