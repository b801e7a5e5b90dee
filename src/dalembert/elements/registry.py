"""The one list of everything a model can be made of: name → class.

A new element is one file, one row here and one line in the documentation. Model files, their
schema, the laws tested over all elements and the reference pages are all made from these tables.
"""

from __future__ import annotations

from dalembert.elements.curves import Curve, FormulaCurve, SplineCurve
from dalembert.elements.laws.base import Formula, Law, Product, Sum
from dalembert.elements.laws.harmonic import Harmonic
from dalembert.elements.laws.polynomial import Polynomial
from dalembert.elements.laws.rise import (
    CycloidalRise,
    HarmonicRise,
    Polynomial345Rise,
    Polynomial4567Rise,
)
from dalembert.elements.laws.table import Table
from dalembert.elements.planar.body import Bar, Body, Particle
from dalembert.elements.planar.drivers import (
    CoordinateDriver,
    DistanceDriver,
    RotationalDriver,
    TranslationalDriver,
)
from dalembert.elements.planar.friction import JointFriction, Stop
from dalembert.elements.planar.gear import Coupling, GearPair, RackAndPinion, RollingDisc
from dalembert.elements.planar.loads import Force, Moment
from dalembert.elements.planar.point_on_curve import PointOnCurve
from dalembert.elements.planar.revolute import Revolute
from dalembert.elements.planar.rigid_link import RigidLink
from dalembert.elements.planar.springs import Actuator, Bushing, RotationalSpring, Spring
from dalembert.elements.planar.translational import PinInSlot, Translational
from dalembert.elements.planar.user_constraint import UserConstraint
from dalembert.elements.planar.weld import Weld

BODIES: dict[str, type[Body]] = {
    "Body": Body,
    "Bar": Bar,
    "Particle": Particle,
}

JOINTS: dict[str, type] = {
    "Revolute": Revolute,
    "Translational": Translational,
    "PinInSlot": PinInSlot,
    "Weld": Weld,
    "RigidLink": RigidLink,
    "PointOnCurve": PointOnCurve,
    "GearPair": GearPair,
    "RackAndPinion": RackAndPinion,
    "RollingDisc": RollingDisc,
    "Coupling": Coupling,
    "UserConstraint": UserConstraint,
}

DRIVERS: dict[str, type] = {
    "RotationalDriver": RotationalDriver,
    "TranslationalDriver": TranslationalDriver,
    "DistanceDriver": DistanceDriver,
    "CoordinateDriver": CoordinateDriver,
}

FORCES: dict[str, type] = {
    "Force": Force,
    "Moment": Moment,
    "Spring": Spring,
    "RotationalSpring": RotationalSpring,
    "Actuator": Actuator,
    "Bushing": Bushing,
    "JointFriction": JointFriction,
    "Stop": Stop,
}

LAWS: dict[str, type[Law]] = {
    "Formula": Formula,
    "Polynomial": Polynomial,
    "Harmonic": Harmonic,
    "HarmonicRise": HarmonicRise,
    "CycloidalRise": CycloidalRise,
    "Polynomial345Rise": Polynomial345Rise,
    "Polynomial4567Rise": Polynomial4567Rise,
    "Table": Table,
    "Sum": Sum,
    "Product": Product,
}

CURVES: dict[str, type[Curve]] = {
    "SplineCurve": SplineCurve,
    "FormulaCurve": FormulaCurve,
}
