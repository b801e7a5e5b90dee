"""Drivers: rheonomic constraints that prescribe a motion.

Each prescribes a coordinate ``s`` by a law, ``Φ = s − f(t) = 0``. Its effort is the generalised
force it exerts along the coordinate, ``−λ``: positive effort pushes the coordinate up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Constraint, Coordinates, Vector, option, quantity
from dalembert.elements.laws.base import GivenLaw, as_law
from dalembert.elements.planar.body import Ground, Point, unit_vector
from dalembert.elements.planar.joint import (
    BodyJoint,
    PointJoint,
    need_point,
)
from dalembert.elements.planar.translational import SlidingJoint
from dalembert.symbolic.expression import t

LEAST = float(np.finfo(float).tiny)


class Driver(Constraint):
    """Prescribes ``coordinate() = law(t)``."""

    law: Any
    name: str
    multiplier: ca.SX
    positive = False
    """The law must stay above zero."""

    def coordinate(self) -> ca.SX:
        """The coordinate that is prescribed."""
        raise NotImplementedError

    @property
    def measured(self) -> str:
        """Name of the measure that the coordinate is."""
        return f"{self.name}.coordinate"

    def residual(self) -> ca.SX:
        self.law = as_law(self.law, f"{self.name}.law")
        coordinate, value = self.compared()
        return coordinate - value

    def compared(self) -> tuple[ca.SX, ca.SX]:
        return self.coordinate(), self.law.value(t.sx)

    def measures(self, rate) -> dict[str, tuple[ca.SX, str]]:
        unit = self.units()[0]
        effort = -self.multiplier
        return {
            "coordinate": (self.coordinate(), unit),
            "effort": (effort, "N m" if unit == "rad" else "N"),
            "power": (effort * rate(self.coordinate()), "W"),
        }

    def conditions(self) -> list[tuple[ca.SX, str]]:
        wanted = list(self.law.conditions())
        if self.positive:
            start = ca.substitute(self.law.value(t.sx), t.sx, 0)
            wanted.append((start - LEAST, "its law asks for no distance at the start"))
        return wanted

    def checked_quantities(self):
        return [*super().checked_quantities(), *self.law.checked_quantities(f"{self.name}.law")]


@dataclass(eq=False)
class RotationalDriver(Driver, BodyJoint):
    """Prescribes the angle of body j relative to body i, ``Φ = φ_j − φ_i − f(t)`` (1.28).

    Parameters
    ----------
    body_i, body_j : with the ground as body i the angle is absolute
    law : Law, number or formula in t [rad]
    """

    law: GivenLaw = option("motion law")
    kind = "driver"

    @property
    def measured(self) -> str:
        fixed = isinstance(self.body_i, Ground)
        return f"{self.body_j.name}.angle" if fixed else super().measured

    def coordinate(self) -> ca.SX:
        return self.body_j.pose_angle - self.body_i.pose_angle


@dataclass(eq=False)
class TranslationalDriver(Driver, SlidingJoint):
    """Prescribes the travel of point_j along an axis of body i, ``Φ = u_iᵀ(r_jP − r_iP) − f(t)``.

    Parameters
    ----------
    axis : (2,) direction in the frame of body i
    law : Law, number or formula in t [m]
    """

    law: GivenLaw = option("motion law", default=None)
    kind = "driver"

    def coordinate(self) -> ca.SX:
        return self.displacement


@dataclass(eq=False)
class DistanceDriver(Driver, PointJoint):
    """Prescribes the distance of two points, ``Φ = |r_jP − r_iP| − f(t)`` (1.29), ``f > 0``.

    Parameters
    ----------
    law : Law, number or formula in t [m], always positive
    """

    law: GivenLaw = option("motion law")
    kind = "driver"
    positive = True

    def coordinate(self) -> ca.SX:
        return ca.sqrt(ca.sumsqr(self.between))


@dataclass(eq=False)
class CoordinateDriver(Driver, Constraint):
    """Prescribes a coordinate of a point, ``Φ = uᵀ r_P − f(t)``.

    Parameters
    ----------
    point : point of a body
    law : Law, number or formula in t [m]
    direction : (2,) direction in inertial axes
    """

    point: Point
    law: GivenLaw = option("motion law")
    direction: Vector = quantity("", "direction in inertial axes", default=(1.0, 0.0), size=2)
    kind = "driver"

    def __post_init__(self) -> None:
        self.point = need_point(self.point, self.name, "point")
        super().__post_init__()

    def coordinate(self) -> ca.SX:
        return ca.dot(unit_vector(self.direction.sx, self.name), self.point.position.sx)

    def parts(self) -> list[Coordinates]:
        return [self.point.body]
