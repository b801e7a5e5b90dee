"""Planar prismatic joint and pin in a slot."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look, Scalar, Vector, quantity
from dalembert.elements.look import Block, Rail, Slider, SlotPin
from dalembert.elements.planar.body import perpendicular, rotation
from dalembert.elements.planar.joint import PinJoint, TreeJoint
from dalembert.elements.rotation import unit


@dataclass(eq=False)
class SlidingJoint(PinJoint):
    """A joint of a point of the second body and a line of the first.

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
        return ca.mtimes(rotation(angle_i), unit(self.axis.sx, f"{self.name}.axis"))

    @property
    def displacement(self) -> ca.SX:
        """Displacement of point_j from point_i along the line."""
        return ca.dot(self.direction, self.between)

    @property
    def rail(self) -> Rail:
        """The line in pictures."""
        return Rail(self.point_i, self.axis.sx, self.displacement)

    @property
    def offset(self) -> ca.SX:
        """Distance of point_j from the line, positive to its left."""
        return ca.dot(perpendicular(self.direction), self.between)


@dataclass(eq=False)
class GuidingJoint(SlidingJoint, TreeJoint):
    """A joint with the point on the line; its first coordinate is the displacement."""

    def joint_coordinates(self) -> dict[str, tuple[ca.SX, str]]:
        return {"displacement": (self.displacement, "m")}

    def opening(self, q: ca.SX, z: ca.SX, angle_i: ca.SX) -> ca.SX:
        direction = self.direction_at(angle_i)
        return q * direction + z[0] * perpendicular(direction)


@dataclass(eq=False)
class Prismatic(GuidingJoint):
    """Slider: point_j on a line of body i, no relative rotation (1.26).

    ``Φ = [n_iᵀ (r_jP − r_iP); φ_j − φ_i − angle] = 0``, n_i the unit normal of the line.

    Parameters
    ----------
    angle : constant angle of the second body relative to the first [rad]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("chute", gravity=(0, -10))
    >>> box = system.add(planar.Body("box", mass=2.0, inertia=0.1, angle=0.6435))
    >>> chute = system.add(planar.Prismatic("chute", system.ground.center, box.center,
    ...     axis=(0.8, 0.6), angle=0.6435))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> motion["box.acceleration"][0].values.round(6)  # 0.6 g down the slope
    array([-4.8, -3.6])
    """

    angle: Scalar = quantity("rad", "angle of the second body relative to the first", default=0.0)

    def residual(self) -> ca.SX:
        return ca.vertcat(self.offset, self.turn - self.angle.sx)

    def units(self) -> list[str]:
        return ["m", "rad"]

    def look(self) -> list[Look]:
        direction = ca.mtimes(rotation(-self.angle.sx), self.axis.sx)
        return [self.rail, Block(self.point_j, direction), Slider(self.point_j, self.point_i)]

    def freedoms(self) -> dict[str, tuple[ca.SX, str]]:
        return {"displacement": (self.displacement, "m")}

    def fixed_turn(self, z: ca.SX) -> ca.SX:
        return self.angle.sx + z[1]


@dataclass(eq=False)
class PinInSlot(GuidingJoint):
    """Pin of body j in a straight slot of body i (revolute–translational).

    ``Φ = n_iᵀ (r_jP − r_iP) = 0``; the bodies may rotate relative to each other.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("yoke")
    >>> crank = system.add(planar.Bar("crank", length=0.2))
    >>> yoke = system.add(planar.Body("yoke"))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, crank.start))
    >>> rail = system.add(planar.Prismatic("rail", system.ground.center, yoke.center))
    >>> pin = system.add(planar.PinInSlot("pin", yoke.center, crank.end, axis=(0, 1)))
    >>> turn = system.add(planar.RotationalDriver("turn", system.ground, crank, da.t))
    >>> motion = da.solve_kinematics(system.build(), "pi/3", step="pi/3")
    >>> motion["yoke.x"].values.round(6)  # 0.2 cos t
    array([0.2, 0.1])
    """

    def residual(self) -> ca.SX:
        return self.offset

    def look(self) -> list[Look]:
        return [self.rail, SlotPin(self.point_j, self.point_i)]

    def freedoms(self) -> dict[str, tuple[ca.SX, str]]:
        return {"displacement": (self.displacement, "m"), **self.turning}
