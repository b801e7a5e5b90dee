"""Translational (prismatic) joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look, Scalar, Vector, quantity
from dalembert.elements.look import Block, Rail, Slider, SlotPin
from dalembert.elements.planar.body import perpendicular, rotation, unit_vector
from dalembert.elements.planar.joint import PinJoint, TreeJoint


@dataclass(eq=False)
class SlidingJoint(PinJoint):
    """A point of the second body moves on a line of the first.

    Parameters
    ----------
    axis : (2,) direction of the line in the frame of the first body
    """

    axis: Vector = quantity(
        "", "direction of the line in the first body's frame", default=(1.0, 0.0), size=2
    )

    @property
    def direction(self) -> ca.SX:
        """Unit vector along the line, inertial axes."""
        return self.direction_at(self.point_i.body.pose_angle)

    def direction_at(self, angle_i: ca.SX) -> ca.SX:
        """The unit vector for an angle of the first body."""
        return ca.mtimes(rotation(angle_i), unit_vector(self.axis.sx, f"{self.name}.axis"))

    @property
    def displacement(self) -> ca.SX:
        """Distance travelled along the line from point_i to point_j."""
        return ca.dot(self.direction, self.between)

    @property
    def rail(self) -> Rail:
        """The line, as pictures show it."""
        return Rail(self.point_i, self.axis.sx, self.displacement)

    @property
    def offset(self) -> ca.SX:
        """Distance of point_j from the line, positive to its left."""
        return ca.dot(perpendicular(self.direction), self.between)


@dataclass(eq=False)
class GuidingJoint(SlidingJoint, TreeJoint):
    """A joint that keeps the point on the line; its first coordinate is the displacement."""

    def joint_coordinates(self) -> dict[str, tuple[ca.SX, str]]:
        return {"displacement": (self.displacement, "m")}

    def opening(self, q: ca.SX, z: ca.SX, angle_i: ca.SX) -> ca.SX:
        along = self.direction_at(angle_i)
        return q * along + z[0] * perpendicular(along)


@dataclass(eq=False)
class Translational(GuidingJoint):
    """Slider: point_j on a line of body i, no relative rotation (1.26).

    ``Φ = [n_iᵀ (r_jP − r_iP); φ_j − φ_i − angle] = 0``, n_i the unit normal of the line.

    Parameters
    ----------
    angle : constant angle of the second body relative to the first [rad]
    """

    angle: Scalar = quantity("rad", "angle of the second body relative to the first", default=0.0)

    def residual(self) -> ca.SX:
        return ca.vertcat(self.offset, self.turn - self.angle.sx)

    def units(self) -> list[str]:
        return ["m", "rad"]

    def look(self) -> list[Look]:
        along = ca.mtimes(rotation(-self.angle.sx), self.axis.sx)
        return [self.rail, Block(self.point_j, along), Slider(self.point_j, self.point_i)]

    def freedoms(self) -> dict[str, tuple[ca.SX, str]]:
        return {"displacement": (self.displacement, "m")}

    def fixed_turn(self, z: ca.SX) -> ca.SX:
        return self.angle.sx + z[1]


@dataclass(eq=False)
class PinInSlot(GuidingJoint):
    """Pin of body j in a straight slot of body i (revolute–translational).

    ``Φ = n_iᵀ (r_jP − r_iP) = 0``; the bodies may turn against each other.
    """

    def residual(self) -> ca.SX:
        return self.offset

    def look(self) -> list[Look]:
        return [self.rail, SlotPin(self.point_j, self.point_i)]

    def freedoms(self) -> dict[str, tuple[ca.SX, str]]:
        return {"displacement": (self.displacement, "m"), **self.turning}
