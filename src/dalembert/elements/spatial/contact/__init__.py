"""Spatial contact: shapes, normal force laws, friction and restitution."""

from dalembert.elements.contact.beam_line import BeamLine
from dalembert.elements.contact.beam_surface import BeamSurface
from dalembert.elements.contact.friction import Coulomb, LuGre, Stribeck
from dalembert.elements.contact.laws import (
    Flores,
    Hertz,
    HuntCrossley,
    KelvinVoigt,
    LankaraniNikravesh,
    Restitution,
)
from dalembert.elements.contact.pairs import Pair
from dalembert.elements.contact.restitution import achieved_restitution, damping_factor
from dalembert.elements.contact.shapes import Vertex
from dalembert.elements.spatial.contact.height_field import HeightField
from dalembert.elements.spatial.contact.mesh_hulls import MeshHulls
from dalembert.elements.spatial.contact.polyhedron import Polyhedron
from dalembert.elements.spatial.contact.shapes import HalfSpace, Socket, Sphere
from dalembert.elements.spatial.contact.solids import Box, Capsule, Corners, Cylinder

__all__ = [
    "BeamLine",
    "BeamSurface",
    "Box",
    "Capsule",
    "Corners",
    "Coulomb",
    "Cylinder",
    "Flores",
    "HalfSpace",
    "HeightField",
    "Hertz",
    "HuntCrossley",
    "KelvinVoigt",
    "LankaraniNikravesh",
    "LuGre",
    "MeshHulls",
    "Pair",
    "Polyhedron",
    "Restitution",
    "Socket",
    "Sphere",
    "Stribeck",
    "Vertex",
    "achieved_restitution",
    "damping_factor",
]
