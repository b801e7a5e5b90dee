"""Spatial elements."""

from dalembert.elements.contact.cable import Cable
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.contact import Contact
from dalembert.elements.driver import DistanceDriver
from dalembert.elements.drives.bristle_friction import BristleFriction
from dalembert.elements.drives.dc_motor import DCMotor
from dalembert.elements.drives.hydraulic_cylinder import HydraulicCylinder
from dalembert.elements.frame import Frame
from dalembert.elements.joint_forces import JointActuator, JointFriction
from dalembert.elements.spatial import contact as contact
from dalembert.elements.spatial.beam import Beam
from dalembert.elements.spatial.body import Body, Particle
from dalembert.elements.spatial.constant_velocity import ConstantVelocity
from dalembert.elements.spatial.contact.shapes import ClearanceSpherical
from dalembert.elements.spatial.couplings import Coupling, GearPair, RackAndPinion
from dalembert.elements.spatial.cylindrical import Cylindrical
from dalembert.elements.spatial.drivers import (
    CoordinateDriver,
    RotationalDriver,
    TranslationalDriver,
)
from dalembert.elements.spatial.flexible_body import FlexibleBody
from dalembert.elements.spatial.geometry import Geometry
from dalembert.elements.spatial.links import (
    RevoluteRevoluteLink,
    RevoluteSphericalLink,
    RigidLink,
)
from dalembert.elements.spatial.loads import Force, Torque
from dalembert.elements.spatial.mesh import Mesh
from dalembert.elements.spatial.node import Node, PointNode
from dalembert.elements.spatial.nonholonomic import KnifeEdge, RollingDisc
from dalembert.elements.spatial.planar_joint import Planar
from dalembert.elements.spatial.point_joints import PointOnCurve, PointOnLine, PointOnPlane
from dalembert.elements.spatial.prismatic import Prismatic
from dalembert.elements.spatial.revolute import Revolute
from dalembert.elements.spatial.screw import Screw
from dalembert.elements.spatial.shapes import Bar, Box, Capsule, Cylinder, Sphere
from dalembert.elements.spatial.spherical import Spherical
from dalembert.elements.spatial.springs import Bushing, TorsionSpring
from dalembert.elements.spatial.unilateral_constraint import UnilateralConstraint
from dalembert.elements.spatial.universal import Universal
from dalembert.elements.spatial.weld import Weld
from dalembert.elements.springs import Actuator, Spring
from dalembert.elements.stop import Stop
from dalembert.elements.user_constraint import UserConstraint

__all__ = [
    "Actuator",
    "Bar",
    "Beam",
    "Body",
    "Box",
    "BristleFriction",
    "Bushing",
    "Cable",
    "Capsule",
    "ClearanceSpherical",
    "Collisions",
    "ConstantVelocity",
    "Contact",
    "CoordinateDriver",
    "Coupling",
    "Cylinder",
    "Cylindrical",
    "DCMotor",
    "DistanceDriver",
    "FlexibleBody",
    "Force",
    "Frame",
    "GearPair",
    "Geometry",
    "HydraulicCylinder",
    "JointActuator",
    "JointFriction",
    "KnifeEdge",
    "Mesh",
    "Node",
    "Particle",
    "Planar",
    "PointNode",
    "PointOnCurve",
    "PointOnLine",
    "PointOnPlane",
    "Prismatic",
    "RackAndPinion",
    "Revolute",
    "RevoluteRevoluteLink",
    "RevoluteSphericalLink",
    "RigidLink",
    "RollingDisc",
    "RotationalDriver",
    "Screw",
    "Sphere",
    "Spherical",
    "Spring",
    "Stop",
    "Torque",
    "TorsionSpring",
    "TranslationalDriver",
    "UnilateralConstraint",
    "Universal",
    "UserConstraint",
    "Weld",
]
