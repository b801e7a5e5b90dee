"""Planar elements."""

from dalembert.elements.contact.cable import Cable
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.contact import Contact
from dalembert.elements.contact.unilateral import UnilateralConstraint
from dalembert.elements.driver import DistanceDriver
from dalembert.elements.drives.bristle_friction import BristleFriction
from dalembert.elements.drives.dc_motor import DCMotor
from dalembert.elements.drives.hydraulic_cylinder import HydraulicCylinder
from dalembert.elements.joint_forces import JointActuator, JointFriction
from dalembert.elements.planar import contact as contact
from dalembert.elements.planar.beam import Beam
from dalembert.elements.planar.body import Bar, Body, Ground, Particle
from dalembert.elements.planar.contact.shapes import ClearanceRevolute
from dalembert.elements.planar.drivers import (
    CoordinateDriver,
    RotationalDriver,
    TranslationalDriver,
)
from dalembert.elements.planar.flexible_body import FlexibleBody
from dalembert.elements.planar.gear import Coupling, GearPair, RackAndPinion, RollingDisc
from dalembert.elements.planar.loads import Force, Torque
from dalembert.elements.planar.node import Node, PointNode
from dalembert.elements.planar.point_on_curve import PointOnCurve
from dalembert.elements.planar.prismatic import PinInSlot, Prismatic
from dalembert.elements.planar.revolute import Revolute
from dalembert.elements.planar.rigid_link import RigidLink
from dalembert.elements.planar.springs import Bushing, TorsionSpring
from dalembert.elements.planar.weld import Weld
from dalembert.elements.point import Point
from dalembert.elements.springs import Actuator, Spring
from dalembert.elements.stop import Stop
from dalembert.elements.user_constraint import UserConstraint
from dalembert.text.wording import no_attribute

__all__ = [
    "Actuator",
    "Bar",
    "Beam",
    "Body",
    "BristleFriction",
    "Bushing",
    "Cable",
    "ClearanceRevolute",
    "Collisions",
    "Contact",
    "CoordinateDriver",
    "Coupling",
    "DCMotor",
    "DistanceDriver",
    "FlexibleBody",
    "Force",
    "GearPair",
    "Ground",
    "HydraulicCylinder",
    "JointActuator",
    "JointFriction",
    "Node",
    "Particle",
    "PinInSlot",
    "Point",
    "PointNode",
    "PointOnCurve",
    "Prismatic",
    "RackAndPinion",
    "Revolute",
    "RigidLink",
    "RollingDisc",
    "RotationalDriver",
    "Spring",
    "Stop",
    "Torque",
    "TorsionSpring",
    "TranslationalDriver",
    "UnilateralConstraint",
    "UserConstraint",
    "Weld",
]


def __getattr__(name: str) -> object:
    raise AttributeError(no_attribute(__name__, name, __all__))
