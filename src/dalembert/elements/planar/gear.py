"""Planar gears, racks, rolling discs and belts: rolling without slip."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look, Scalar, option, quantity
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Belt, Disc, Mesh
from dalembert.elements.pair import initial_value, need_body
from dalembert.elements.planar.body import Body, cross
from dalembert.elements.planar.joint import BodyJoint, PinJoint
from dalembert.elements.planar.prismatic import SlidingJoint
from dalembert.errors import ModelError


@dataclass(eq=False)
class GearPair(PinJoint):
    """Two gears in mesh: the pitch circles roll without slip.

    ``Φ = r_i (φ_i − θ) ± r_j (φ_j − θ) − const = 0``, + external, − internal (gear j is the
    ring); θ is the direction of the line of centres, so that the tooth force loads the
    bearings. The constant is taken from the initial poses. The multiplier is the tooth force.

    Parameters
    ----------
    point_i, point_j : centres of the gears, points of the two gear bodies
    radius_i, radius_j : pitch radii [m]
    internal : gear j is a ring with inner teeth

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("gears")
    >>> pinion, wheel = (system.add(planar.Body(name)) for name in ("pinion", "wheel"))
    >>> a = system.add(planar.Revolute("A", system.ground.center, pinion.center))
    >>> b = system.add(planar.Revolute("B", system.ground.point(0.4, 0), wheel.center))
    >>> centers = pinion.center, wheel.center
    >>> mesh = system.add(planar.GearPair("mesh", *centers, radius_i=0.1, radius_j=0.3))
    >>> turn = system.add(planar.RotationalDriver("turn", system.ground, pinion, 6 * da.t))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=1.0)
    >>> motion["wheel.angular_velocity"].values.round(6)  # opposite, by the ratio of the radii
    array([-2., -2.])
    """

    radius_i: Scalar = quantity("m", "pitch radius of the first gear", above=0.0, keyword=True)
    radius_j: Scalar = quantity("m", "pitch radius of the second gear", above=0.0, keyword=True)
    internal: bool = option("the second gear is a ring with inner teeth", default=False)

    def residual(self) -> ca.SX:
        bodies = list(self.ends())
        start = initial_value(self.between, bodies).sx
        degenerate = start.is_constant() and float(ca.norm_2(start)) == 0
        reference = ca.SX([1, 0]) if degenerate else start
        line = ca.atan2(cross(reference, self.between), ca.dot(reference, self.between))
        sign = -1 if self.internal else 1
        rolled = self.radius_i.sx * self.point_i.body.pose_angle
        rolled += sign * self.radius_j.sx * self.point_j.body.pose_angle
        rolled -= initial_value(rolled - self.centres * line, bodies).sx
        # the angles of the gears determine the number of revolutions of the line of centres
        turn = rolled / self.centres - line
        return self.centres * (turn - 2 * math.pi * ca.floor(turn / (2 * math.pi) + 0.5))

    def look(self) -> list[Look]:
        i, j, radii = self.point_i, self.point_j, (self.radius_i.sx, self.radius_j.sx)
        return [Disc(i, radii[0]), Disc(j, radii[1]), Mesh(j, i, radii[1], radii[0], self.internal)]

    @property
    def centres(self) -> ca.SX:
        """``r_i ± r_j``: signed centre distance."""
        return self.radius_i.sx + (-1 if self.internal else 1) * self.radius_j.sx


@dataclass(eq=False)
class RackAndPinion(SlidingJoint):
    """Pinion (body j, centre point_j) rolls on a pitch line of body i without slip.

    ``Φ = s + side · r (φ_j − φ_i) − const = 0`` with the displacement s of the centre along the
    axis. On the left of the axis (``side = 1``) rolling forward rotates the pinion clockwise. The
    constant is taken from the initial poses. The multiplier is the force along the pitch line.

    Parameters
    ----------
    radius : pitch radius of the pinion [m]
    side : +1 pinion on the left of the axis, −1 on its right

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("steering")
    >>> pinion, rack = system.add(planar.Body("pinion")), system.add(planar.Body("rack"))
    >>> hinge = system.add(planar.Revolute("O", system.ground.point(0, 0.02), pinion.center))
    >>> rail = system.add(planar.Prismatic("rail", system.ground.center, rack.center))
    >>> mesh = system.add(planar.RackAndPinion("mesh", rack.center, pinion.center, radius=0.02))
    >>> turn = system.add(planar.RotationalDriver("turn", system.ground, pinion, da.t))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=1.0)
    >>> motion["rack.x"].values.round(6)  # r φ
    array([0.  , 0.02])
    """

    radius: Scalar = quantity("m", "pitch radius", above=0.0, keyword=True)
    side: int = option("+1: left of the axis, -1: right of it", default=1)

    def __post_init__(self) -> None:
        if self.side not in (1, -1):
            raise ModelError(f"side must be 1 or -1, got {self.side!r}", self.name)
        super().__post_init__()

    @property
    def no_slip(self) -> ca.SX:
        rolled = self.displacement + self.side * self.radius.sx * self.turn
        return rolled - initial_value(rolled, list(self.ends())).sx

    def residual(self) -> ca.SX:
        return self.no_slip

    def look(self) -> list[Look]:
        return [self.rail, Disc(self.point_j, self.radius.sx), *super().look()]

    def place(self) -> ca.SX:
        """The pitch point."""
        normal = ca.vertcat(-self.direction[1], self.direction[0])
        return self.point_j.position.sx - self.side * self.radius.sx * normal


@dataclass(eq=False)
class RollingDisc(RackAndPinion):
    """Disc (body j, centre point_j) rolls without slip on a line of body i.

    ``Φ = [n_iᵀ (r_jP − r_iP) − side · r; no slip] = 0``: contact and rolling
    ``x − x0 = −r (φ − φ0)``. The multipliers are the normal and the friction force.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("wheel", gravity=(5, -9.81))
    >>> wheel = system.add(planar.Body("wheel", mass=2.0, inertia=0.09, position=(0, 0.3)))
    >>> road = planar.RollingDisc("road", system.ground.center, wheel.center, radius=0.3)
    >>> contact = system.add(road)
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> round(motion["wheel.vx"][-1].item(), 6)  # g t/(1 + J/(m r²)) with J = m r²/2
    3.333333
    """

    def residual(self) -> ca.SX:
        return ca.vertcat(self.offset - self.side * self.radius.sx, self.no_slip)


@dataclass(eq=False)
class Coupling(BodyJoint):
    """Fixed ratio between two rotations (belt, chain, gearbox).

    ``Φ = (φ_j − φ_c) − ratio (φ_i − φ_c) − const = 0``; the constant is taken from the initial
    poses. A belt has ``ratio = r_i/r_j``; crossed, ``−r_i/r_j``. The multiplier is a torque.

    Parameters
    ----------
    ratio : rotation of body j per rotation of body i
    carrier : body that carries both axes; the ground by default

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("belt")
    >>> motor, drum = (system.add(planar.Body(name)) for name in ("motor", "drum"))
    >>> a = system.add(planar.Revolute("A", system.ground.center, motor.center))
    >>> b = system.add(planar.Revolute("B", system.ground.point(0.5, 0), drum.center))
    >>> belt = system.add(planar.Coupling("belt", motor, drum, ratio=0.25))
    >>> turn = system.add(planar.RotationalDriver("turn", system.ground, motor, 8 * da.t))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=1.0)
    >>> motion["drum.angular_velocity"].values.round(6)
    array([2., 2.])
    """

    ratio: Scalar = quantity("", "rotation of body j per rotation of body i", default=1.0)
    carrier: Body = option("body that carries both axes", default=None)

    def __post_init__(self) -> None:
        if self.carrier is not None:
            self.carrier = need_body(self.carrier, self.name, "carrier")
        super().__post_init__()

    def look(self) -> list[Look]:
        return [Belt(self.body_i, self.body_j, self.ratio.sx, self.carrier)]

    def parts(self) -> list[Coordinates]:
        return [*super().parts(), *([self.carrier] if self.carrier is not None else [])]

    def residual(self) -> ca.SX:
        base = self.carrier.pose_angle if self.carrier is not None else ca.SX(0)
        relative = (self.body_j.pose_angle - base) - self.ratio.sx * (self.body_i.pose_angle - base)
        bodies = [b for b in (*self.ends(), self.carrier) if b is not None]
        return relative - initial_value(relative, bodies).sx
