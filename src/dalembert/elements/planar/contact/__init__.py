"""Planar contact: shapes, normal force laws, friction and restitution."""

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
from dalembert.elements.planar.contact.capsule import Capsule
from dalembert.elements.planar.contact.outline import Outline
from dalembert.elements.planar.contact.polygon import Polygon, Rectangle
from dalembert.elements.planar.contact.profile import Profile
from dalembert.elements.planar.contact.shapes import Bore, Circle, HalfPlane
from dalembert.elements.planar.contact.sprocket import Sprocket

__all__ = [
    "BeamLine",
    "BeamSurface",
    "Bore",
    "Capsule",
    "Circle",
    "Coulomb",
    "Flores",
    "HalfPlane",
    "Hertz",
    "HuntCrossley",
    "KelvinVoigt",
    "LankaraniNikravesh",
    "LuGre",
    "Outline",
    "Pair",
    "Polygon",
    "Profile",
    "Rectangle",
    "Restitution",
    "Sprocket",
    "Stribeck",
    "Vertex",
    "achieved_restitution",
    "damping_factor",
]
