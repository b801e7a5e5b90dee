"""Rotational springs and bushings of the plane."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import (
    Coordinates,
    ForceElement,
    Look,
    Powers,
    Rate,
    Scalar,
    Vector,
    option,
    quantity,
)
from dalembert.elements.look import Brake, Sleeve, Spiral
from dalembert.elements.pair import need_body, refuse_same_body
from dalembert.elements.planar.body import Body, rotation
from dalembert.elements.springs import ForceLaw, PointPair, SpringDamper
from dalembert.errors import ModelError


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

    def look(self) -> list[Look]:
        return self.drawn(Spiral, Brake, self.body_i, self.body_j)


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
        local = ca.mtimes(rotation(self.point_i.body.pose_angle).T, self.between)
        turn = self.point_j.body.pose_angle - self.point_i.body.pose_angle
        k, c = self.stiffness.sx, self.damping.sx
        return [
            (local[0], k[0], c[0]),
            (local[1], k[1], c[1]),
            (turn, self.rotational_stiffness.sx, self.rotational_damping.sx),
        ]

    def look(self) -> list[Look]:
        return [Sleeve(self.point_i, self.point_j)]

    def powers(self, rate: Rate) -> Powers:
        return [(rate(s), -(k * s + c * rate(s))) for s, k, c in self.coordinates()]

    def potential(self) -> ca.SX:
        return sum((k * s**2 / 2 for s, k, _ in self.coordinates()), ca.SX(0))

    def dissipation(self, rate: Rate) -> Powers:
        return [(rate(s), -c * rate(s)) for s, _, c in self.coordinates()]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        (x, kx, cx), (y, ky, cy), (a, ka, cra) = self.coordinates()
        force = ca.vertcat(kx * x + cx * rate(x), ky * y + cy * rate(y))
        return {
            "deflection": (ca.vertcat(x, y), "m"),
            "force": (force, "N"),
            "moment": (ka * a + cra * rate(a), "N m"),
        }
