"""Drivers: rheonomic constraints that prescribe a motion.

A driver prescribes a coordinate ``s`` by a law, ``Φ = s − f(t) = 0``. Its effort is the generalised
force along the coordinate, ``−λ``: a positive effort increases the coordinate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Condition, Constraint, Look, option
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.laws.base import GivenLaw, as_law
from dalembert.elements.look import Cylinder, Travel
from dalembert.elements.pair import PointJoint, need_point
from dalembert.elements.point import Point
from dalembert.elements.rotation import unit
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import t

LEAST = float(np.finfo(float).tiny)
"""Lower limit of the initial value of a law that must be positive."""


class Driver(Constraint):
    """Constraint ``coordinate() = law(t)``."""

    law: Any
    name: str
    multiplier: ca.SX
    prescribes = "m"
    """Unit of the coordinate."""
    positive = False
    """Whether the law must stay above zero."""

    def coordinate(self) -> ca.SX:
        """The prescribed coordinate."""
        raise NotImplementedError

    @property
    def measured(self) -> str:
        """Name of the measure of the coordinate."""
        return f"{self.name}.coordinate"

    def residual(self) -> ca.SX:
        self.law = as_law(self.law, f"{self.name}.law", self.prescribes)
        return self.deviation()

    def deviation(self) -> ca.SX:
        """Difference of the coordinate and the law."""
        coordinate, value = self.measured_and_target()
        return coordinate - value

    def measured_and_target(self) -> tuple[ca.SX, ca.SX]:
        return self.coordinate(), self.law.value(t.sx)

    def measures(self, rate) -> dict[str, tuple[ca.SX, str]]:
        unit = self.units()[0]
        effort = -self.multiplier
        return {
            "coordinate": (self.coordinate(), unit),
            "effort": (effort, "N m" if unit == "rad" else "N"),
            "power": (effort * rate(self.coordinate()), "W"),
        }

    def conditions(self) -> list[Condition]:
        conditions = list(self.law.conditions())
        if self.positive:
            start = ca.substitute(self.law.value(t.sx), t.sx, 0)
            conditions.append((start - LEAST, "its law is not positive at the start"))
        return conditions

    def warnings(self) -> list[Condition]:
        """Warnings of tables that do not determine the second derivative of the law."""
        texts = dict.fromkeys(spline.end_warning() for spline in self.law.splines())
        return [(ca.SX(-1), text) for text in texts if text]

    def checked_quantities(self):
        return [*super().checked_quantities(), *self.law.checked_quantities(f"{self.name}.law")]


@dataclass(eq=False)
class DistanceDriver(Driver, PointJoint):
    """Prescribed distance of two points, ``Φ = |r_jP − r_iP| − f(t)`` (1.29), ``f > 0``.

    Parameters
    ----------
    law : Law, number or formula in t [m], always positive

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("boom")
    >>> boom = system.add(planar.Bar("boom", length=0.8, angle=0.9))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, boom.start))
    >>> foot = system.ground.point(0.6, 0)
    >>> ram = system.add(planar.DistanceDriver("ram", foot, boom.end, 1.0))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=1.0)
    >>> round(motion["boom.end.y"][0].item(), 6)  # right triangle 0.6, 0.8, 1
    0.8
    """

    law: GivenLaw = option("motion law")
    positive = True

    def coordinate(self) -> ca.SX:
        return self.distance

    def look(self) -> list[Look]:
        return [Cylinder(self.point_i, self.point_j)]


class AlongDirection(Driver):
    """Prescribed coordinate of a point along a direction in inertial axes."""

    point: Point
    direction: Any

    def __post_init__(self) -> None:
        self.point = need_point(self.point, self.name, "point")
        super().__post_init__()

    def residual(self) -> ca.SX:
        if len(self.direction) != self.point.dimension:
            raise ModelError(
                f"its direction has {len(self.direction)} components and the point of "
                f"{self.point.body.name} has {self.point.dimension} coordinates; use the driver "
                "of the planar or the spatial elements",
                self.name,
            )
        return super().residual()

    def coordinate(self) -> ca.SX:
        direction = unit(self.direction.sx, f"{self.name}.direction")
        return ca.dot(direction, self.point.position.sx)

    def look(self) -> list[Look]:
        return [Travel(self.point, None, self.direction.sx)]

    def parts(self) -> list[Coordinates]:
        return [self.point.body]
