"""Registry of finite elements: name → class.

Model files, their schema, meshes, pictures and the tests over all elements are generated from these
tables. A new element is one file, one row in ``ELEMENTS`` and, unless it is a straight line between
two nodes, one in ``SHAPES``.
"""

from __future__ import annotations

from dalembert.elements.fem.attached import (
    GroundRotationSpring,
    GroundSpring,
    PointInertia,
    PointMass,
)
from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.energies import Energies
from dalembert.elements.fem.frame import Frame, TimoshenkoFrame
from dalembert.elements.fem.lines import AxialSpring
from dalembert.elements.fem.plane import Quadrilateral, Quadrilateral8, Triangle, Triangle6
from dalembert.elements.fem.solid import Hexahedron, Hexahedron20, Tetrahedron, Tetrahedron10
from dalembert.elements.fem.space_frame import SpaceFrame, TimoshenkoSpaceFrame
from dalembert.elements.fem.truss import Truss

ELEMENTS: dict[str, type[StructuralElement]] = {
    "AxialSpring": AxialSpring,
    "Truss": Truss,
    "Frame": Frame,
    "TimoshenkoFrame": TimoshenkoFrame,
    "SpaceFrame": SpaceFrame,
    "TimoshenkoSpaceFrame": TimoshenkoSpaceFrame,
    "Triangle": Triangle,
    "Triangle6": Triangle6,
    "Quadrilateral": Quadrilateral,
    "Quadrilateral8": Quadrilateral8,
    "Tetrahedron": Tetrahedron,
    "Tetrahedron10": Tetrahedron10,
    "Hexahedron": Hexahedron,
    "Hexahedron20": Hexahedron20,
    "GroundSpring": GroundSpring,
    "GroundRotationSpring": GroundRotationSpring,
    "PointMass": PointMass,
    "PointInertia": PointInertia,
}

SHAPES: dict[type[StructuralElement], str] = {
    Triangle: "triangle",
    Triangle6: "triangle6",
    Quadrilateral: "quad",
    Quadrilateral8: "quad8",
    Tetrahedron: "tetra",
    Tetrahedron10: "tetra10",
    Hexahedron: "hexahedron",
    Hexahedron20: "hexahedron20",
}
"""Class → name of its cell in meshes; both have the node order of VTK."""


def cell_of(cls: type[Energies]) -> str:
    """Cell name of a class: its row, that of a base class, or one by its number of nodes."""
    cell = next((SHAPES[base] for base in cls.__mro__ if base in SHAPES), None)
    return cell or {1: "vertex", 2: "line"}.get(cls.node_count, "polygon")


def element_for(cell: str, dimension: int) -> type[StructuralElement] | None:
    """The default class of a cell of a mesh."""
    fitting = [c for c, kind in SHAPES.items() if kind == cell and dimension in c.dimensions]
    return fitting[0] if fitting else None
