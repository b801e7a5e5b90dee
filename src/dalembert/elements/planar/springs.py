"""Springs, dampers, actuators and bushings between two points or two bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.base import (
    Coordinates,
    ForceElement,
    Rate,
    Scalar,
    Vector,
    option,
    quantity,
)
from dalembert.elements.planar.body import Body, Point, rotation
from dalembert.elements.planar.joint import need_body, need_point, refuse_same_body
from dalembert.errors import ModelError
from dalembert.symbolic.expression import Expression, as_expression

SMALLEST_LENGTH = 1e-30
ForceLaw = Callable[[Expression, Expression], Any]
"""Force of an extension and its rate."""


class SpringDamper(ForceElement):
    """What translational and rotational springs share: a force along one coordinate ``s``.

    ``F = k (s − s0) + c ṡ``, or any ``law(s − s0, ṡ)``; it acts against the coordinate, so that
    a positive force pulls (tension).
    """

    name: str
    coordinate_name = "length"
    coordinate_unit = "m"
    force_name = "force"
    force_unit = "N"

    stiffness: Scalar
    damping: Scalar
    law: ForceLaw | None

    def relaxed(self) -> ca.SX:
        raise NotImplementedError

    def elastic(self) -> ca.SX:
        """Force of the spring alone."""
        return self.stiffness.sx * (self.coordinate() - self.relaxed())

    def force(self, rate: Rate) -> ca.SX:
        s = self.coordinate()
        linear = self.elastic() + self.damping.sx * rate(s)
        if self.law is None:
            return linear
        extension = Expression(s - self.relaxed(), "extension", self.coordinate_unit)
        value = self.law(extension, Expression(rate(s), "rate"))
        return linear + as_expression(value, f"{self.name}.law", self.force_unit).sx

    def works(self, rate: Rate) -> list[tuple[ca.SX, ca.SX]]:
        return [(self.coordinate(), -self.force(rate))]

    def potential(self) -> ca.SX:
        return self.stiffness.sx * (self.coordinate() - self.relaxed()) ** 2 / 2

    def dissipation(self, rate: Rate) -> list[tuple[ca.SX, ca.SX]]:
        s = self.coordinate()
        return [(s, -self.damping.sx * rate(s))]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        s = self.coordinate()
        return {
            self.coordinate_name: (s, self.coordinate_unit),
            "rate": (rate(s), f"{self.coordinate_unit}/s"),
            self.force_name: (self.force(rate), self.force_unit),
        }


@dataclass(eq=False)
class PointPair(ForceElement):
    """Force element between two points; its coordinate is their distance.

    Parameters
    ----------
    point_i, point_j : points of two bodies
    """

    point_i: Point
    point_j: Point

    def __post_init__(self) -> None:
        self.point_i = need_point(self.point_i, self.name, "point_i")
        self.point_j = need_point(self.point_j, self.name, "point_j")
        refuse_same_body(self.point_i.body, self.point_j.body, self.name)
        super().__post_init__()

    def parts(self) -> list[Coordinates]:
        return [self.point_i.body, self.point_j.body]

    def between(self) -> ca.SX:
        return self.point_j.position.sx - self.point_i.position.sx

    def coordinate(self) -> ca.SX:
        return ca.sqrt(ca.sumsqr(self.between()))


@dataclass(eq=False)
class Spring(SpringDamper, PointPair):
    """Spring and damper in parallel between two points (1.56–1.64).

    Parameters
    ----------
    stiffness : [N/m]
    damping : [N s/m]
    free_length : [m]
    law : function (extension, rate) → additional force [N], positive in tension
    """

    stiffness: Scalar = quantity("N/m", "stiffness", default=0.0)
    damping: Scalar = quantity("N s/m", "damping", default=0.0)
    free_length: Scalar = quantity("m", "free length", default=0.0, minimum=0.0)
    law: ForceLaw | None = option("additional force, formula of extension and rate", default=None)

    def coordinate(self) -> ca.SX:
        if self.free_length.sx.is_zero():  # its force has a limit at length zero
            return ca.sqrt(ca.sumsqr(self.between()) + SMALLEST_LENGTH**2)
        return super().coordinate()

    def relaxed(self) -> ca.SX:
        return self.free_length.sx


@dataclass(eq=False)
class BodyPair(ForceElement):
    """Force element between the angles of two bodies.

    Parameters
    ----------
    body_i, body_j : first and second body; the coordinate is ``φ_j − φ_i``
    """

    body_i: Body
    body_j: Body

    def __post_init__(self) -> None:
        self.body_i = need_body(self.body_i, self.name, "body_i")
        self.body_j = need_body(self.body_j, self.name, "body_j")
        refuse_same_body(self.body_i, self.body_j, self.name)
        for body in (self.body_i, self.body_j):
            if not body.rotates:
                raise ModelError(f"{body.name} is a particle and has no angle", self.name)
        super().__post_init__()

    def parts(self) -> list[Coordinates]:
        return [self.body_i, self.body_j]

    def coordinate(self) -> ca.SX:
        return self.body_j.pose_angle - self.body_i.pose_angle


@dataclass(eq=False)
class RotationalSpring(SpringDamper, BodyPair):
    """Rotational spring and damper between two bodies.

    Parameters
    ----------
    stiffness : [N m/rad]
    damping : [N m s/rad]
    free_angle : [rad]
    law : function (extension, rate) → additional moment [N m]
    """

    stiffness: Scalar = quantity("N m/rad", "stiffness", default=0.0)
    damping: Scalar = quantity("N m s/rad", "damping", default=0.0)
    free_angle: Scalar = quantity("rad", "angle without moment", default=0.0)
    law: ForceLaw | None = option("additional moment, formula of extension and rate", default=None)
    coordinate_name = "angle"
    coordinate_unit = "rad"
    force_name = "moment"
    force_unit = "N m"

    def relaxed(self) -> ca.SX:
        return self.free_angle.sx


@dataclass(eq=False)
class Actuator(PointPair):
    """Force along the line of two points; positive pushes them apart.

    Parameters
    ----------
    force : [N]; formula of t, parameters and measures
    """

    force: Scalar = quantity("N", "force, positive pushes apart")

    def works(self, rate: Rate) -> list[tuple[ca.SX, ca.SX]]:
        return [(self.coordinate(), self.force.sx)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        s = self.coordinate()
        return {
            "length": (s, "m"),
            "rate": (rate(s), "m/s"),
            "force": (self.force.sx, "N"),
            "power": (self.force.sx * rate(s), "W"),
        }


@dataclass(eq=False)
class Bushing(PointPair):
    """Elastic bearing: stiffness and damping along two axes of body i and about the pin.

    Parameters
    ----------
    stiffness : (2,) along the axes of body i [N/m]
    damping : (2,) [N s/m]
    rotational_stiffness, rotational_damping : [N m/rad], [N m s/rad]
    """

    stiffness: Vector = quantity("N/m", "stiffness along the axes of body i", size=2)
    damping: Vector = quantity("N s/m", "damping", default=(0.0, 0.0), size=2)
    rotational_stiffness: Scalar = quantity("N m/rad", "rotational stiffness", default=0.0)
    rotational_damping: Scalar = quantity("N m s/rad", "rotational damping", default=0.0)

    def coordinates(self) -> list[tuple[ca.SX, ca.SX, ca.SX]]:
        """(coordinate, stiffness, damping) of the three deformations."""
        local = ca.mtimes(rotation(self.point_i.body.pose_angle).T, self.between())
        turn = self.point_j.body.pose_angle - self.point_i.body.pose_angle
        k, c = self.stiffness.sx, self.damping.sx
        return [
            (local[0], k[0], c[0]),
            (local[1], k[1], c[1]),
            (turn, self.rotational_stiffness.sx, self.rotational_damping.sx),
        ]

    def works(self, rate: Rate) -> list[tuple[ca.SX, ca.SX]]:
        return [(s, -(k * s + c * rate(s))) for s, k, c in self.coordinates()]

    def potential(self) -> ca.SX:
        return sum((k * s**2 / 2 for s, k, _ in self.coordinates()), ca.SX(0))

    def dissipation(self, rate: Rate) -> list[tuple[ca.SX, ca.SX]]:
        return [(s, -c * rate(s)) for s, _, c in self.coordinates()]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        (x, kx, cx), (y, ky, cy), (a, ka, cra) = self.coordinates()
        force = ca.vertcat(kx * x + cx * rate(x), ky * y + cy * rate(y))
        return {
            "deflection": (ca.vertcat(x, y), "m"),
            "force": (force, "N"),
            "moment": (ka * a + cra * rate(a), "N m"),
        }
