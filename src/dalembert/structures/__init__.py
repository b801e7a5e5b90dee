"""Structures: nodes, elements between them, supports and loads; finite-element assembly."""

from dalembert.structures.frame import Frame, TimoshenkoFrame
from dalembert.structures.node import Node
from dalembert.structures.plane import Quadrilateral, Triangle
from dalembert.structures.springs import AxialSpring
from dalembert.structures.structure import Structure
from dalembert.structures.truss import Truss

__all__ = [
    "AxialSpring",
    "Frame",
    "Node",
    "Quadrilateral",
    "Structure",
    "TimoshenkoFrame",
    "Triangle",
    "Truss",
]
