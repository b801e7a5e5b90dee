"""Registry of elements, laws, curves and shapes: name → class.

A new element is one file, one row here and one line in the documentation. Model files, their
schema, the tests over all elements and the reference pages are generated from these tables.
Planar and spatial elements have separate tables, so that both may use the same name.
"""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.elements import blocks, planar, spatial
from dalembert.elements.curves import FormulaCurve, SplineCurve
from dalembert.elements.laws.base import Formula, Harmonic, Polynomial, Product, Sum
from dalembert.elements.laws.rise import (
    CycloidalRise,
    HarmonicRise,
    Polynomial345Rise,
    Polynomial4567Rise,
)
from dalembert.elements.laws.table import Table


@dataclass(frozen=True, eq=False)
class Space:
    """The elements of planar or spatial mechanisms.

    Attributes
    ----------
    name : the module of its elements
    dimension : number of coordinates of a point
    sections : section of a model file → name → class
    """

    name: str
    dimension: int
    sections: dict[str, dict[str, type]]


def named(*classes: type) -> dict[str, type]:
    """Classes by their names."""
    return {cls.__name__: cls for cls in classes}


PLANAR = Space(
    "planar",
    2,
    {
        "bodies": named(
            planar.Body,
            planar.Bar,
            planar.Particle,
            planar.FlexibleBody,
            planar.Node,
            planar.PointNode,
        ),
        "beams": named(planar.Beam),
        "joints": named(
            planar.Revolute,
            planar.Prismatic,
            planar.PinInSlot,
            planar.Weld,
            planar.RigidLink,
            planar.PointOnCurve,
            planar.GearPair,
            planar.RackAndPinion,
            planar.RollingDisc,
            planar.Coupling,
            planar.UserConstraint,
        ),
        "drivers": named(
            planar.RotationalDriver,
            planar.TranslationalDriver,
            planar.DistanceDriver,
            planar.CoordinateDriver,
        ),
        "forces": named(
            planar.Force,
            planar.Torque,
            planar.Spring,
            planar.TorsionSpring,
            planar.Actuator,
            planar.Bushing,
            planar.JointFriction,
            planar.JointActuator,
            planar.BristleFriction,
            planar.DCMotor,
            planar.HydraulicCylinder,
            planar.Stop,
            planar.Contact,
            planar.ClearanceRevolute,
            planar.Cable,
            planar.UnilateralConstraint,
            planar.Collisions,
        ),
    },
)
SPATIAL = Space(
    "spatial",
    3,
    {
        "bodies": named(
            spatial.Body,
            spatial.Particle,
            spatial.Bar,
            spatial.Box,
            spatial.Cylinder,
            spatial.Sphere,
            spatial.Capsule,
            spatial.Mesh,
            spatial.FlexibleBody,
            spatial.Node,
            spatial.PointNode,
        ),
        "beams": named(spatial.Beam),
        "joints": named(
            spatial.Spherical,
            spatial.Revolute,
            spatial.Cylindrical,
            spatial.Prismatic,
            spatial.Universal,
            spatial.ConstantVelocity,
            spatial.Screw,
            spatial.Planar,
            spatial.Weld,
            spatial.PointOnLine,
            spatial.PointOnPlane,
            spatial.PointOnCurve,
            spatial.RigidLink,
            spatial.RevoluteSphericalLink,
            spatial.RevoluteRevoluteLink,
            spatial.GearPair,
            spatial.RackAndPinion,
            spatial.Coupling,
            spatial.RollingDisc,
            spatial.KnifeEdge,
            spatial.UserConstraint,
        ),
        "drivers": named(
            spatial.RotationalDriver,
            spatial.TranslationalDriver,
            spatial.DistanceDriver,
            spatial.CoordinateDriver,
        ),
        "forces": named(
            spatial.Force,
            spatial.Torque,
            spatial.Spring,
            spatial.TorsionSpring,
            spatial.Bushing,
            spatial.Actuator,
            spatial.JointFriction,
            spatial.JointActuator,
            spatial.BristleFriction,
            spatial.DCMotor,
            spatial.HydraulicCylinder,
            spatial.Stop,
            spatial.Contact,
            spatial.ClearanceSpherical,
            spatial.Cable,
            spatial.UnilateralConstraint,
            spatial.Collisions,
        ),
    },
)
SPACES = {space.dimension: space for space in (PLANAR, SPATIAL)}
"""Dimension → elements."""


def elements_of(space: Space, section: str) -> dict[str, type]:
    """Classes that a mechanism of this space may contain, by their names in model files.

    Those of its own space are named ``Revolute`` or ``planar.Revolute``, others only the latter.
    """
    qualified = {
        f"{origin.name}.{name}": cls
        for origin in SPACES.values()
        for name, cls in origin.sections[section].items()
    }
    return space.sections[section] | qualified


BLOCKS = named(
    blocks.State,
    blocks.PID,
    blocks.TransferFunction,
    blocks.StateSpace,
    blocks.LeadLag,
    blocks.LowPass,
    blocks.TransportDelay,
    blocks.SampledState,
    blocks.SampledPID,
    blocks.SampledTransferFunction,
    blocks.SampledStateSpace,
    blocks.ZeroOrderHold,
    blocks.Delay,
    blocks.Quantizer,
)
LAWS = named(
    Formula,
    Polynomial,
    Harmonic,
    HarmonicRise,
    CycloidalRise,
    Polynomial345Rise,
    Polynomial4567Rise,
    Table,
    Sum,
    Product,
)
CURVES = named(SplineCurve, FormulaCurve)
SHAPES = {
    2: named(
        planar.contact.Vertex,
        planar.contact.Circle,
        planar.contact.Bore,
        planar.contact.HalfPlane,
        planar.contact.Polygon,
        planar.contact.Rectangle,
        planar.contact.Outline,
        planar.contact.Capsule,
        planar.contact.Sprocket,
        planar.contact.Profile,
        planar.contact.BeamLine,
        planar.contact.BeamSurface,
    ),
    3: named(
        spatial.contact.Vertex,
        spatial.contact.Sphere,
        spatial.contact.Socket,
        spatial.contact.HalfSpace,
        spatial.contact.Box,
        spatial.contact.Capsule,
        spatial.contact.Cylinder,
        spatial.contact.Corners,
        spatial.contact.HeightField,
        spatial.contact.MeshHulls,
        spatial.contact.Polyhedron,
        spatial.contact.BeamLine,
        spatial.contact.BeamSurface,
    ),
}
"""Dimension → contact shapes."""
CONTACT_LAWS = named(
    planar.contact.Hertz,
    planar.contact.HuntCrossley,
    planar.contact.LankaraniNikravesh,
    planar.contact.Flores,
    planar.contact.KelvinVoigt,
    planar.contact.Restitution,
)
FRICTIONS = named(planar.contact.Coulomb, planar.contact.Stribeck, planar.contact.LuGre)
CONTACT_PAIRS = named(planar.contact.Pair)
"""Coefficients between groups of shapes."""
