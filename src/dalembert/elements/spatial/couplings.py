"""Spatial gears, racks and belts: motions of two joints in a fixed ratio.

The shared motion is an additional massless coordinate ``u``, measured from the initial poses:
``Φ = [s_i − a_i u; s_j − a_j u] = 0``. The ratio therefore holds over any number of revolutions,
although poses determine an angle only up to full revolutions.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Constraint, Look, Rate, Scalar, option, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.joint_forces import free_motion
from dalembert.elements.look import Belt, Disc, Mesh, Rail, Tie
from dalembert.elements.pair import Pair, initial_value
from dalembert.elements.spatial.frame_pair import Turn
from dalembert.elements.spatial.joint import SpatialJoint, slide_of, turn_of
from dalembert.errors import ModelError


class SharedMotion(Coordinates):
    """Shared motion of two coupled joints: one massless coordinate."""

    def __init__(self, name: str, unit: str):
        self.name = f"{name}.shared"
        self.make_symbols(("u",), (unit,))

    def guesses(self) -> tuple[list, list]:
        return [ca.SX(0)], [None]


def turn_deviation(joint: SpatialJoint, motion: str | None, angle: ca.SX, owner: str) -> ca.SX:
    """Difference of a rotation from the initial poses and an angle, below half a turn."""
    turn = turn_of(joint, motion, owner)
    start = initial_value(turn.pair, joint.ends()).sx
    return turn.relative_to(Turn(*ca.vertsplit(start))).relative_to(Turn.of(angle)).angle


def travel_deviation(joint: SpatialJoint, motion: str | None, travel: ca.SX, owner: str) -> ca.SX:
    """Difference of a displacement from the initial poses and a prescribed one."""
    displacement = joint.travel[slide_of(joint, motion, owner)]
    return displacement - initial_value(displacement, joint.ends()).sx - travel


@dataclass(eq=False)
class CoupledJoints(Pair, Constraint):
    """A fixed ratio between the motions of two joints.

    Its reaction is that on the second body of the second joint.

    Parameters
    ----------
    joint_i, joint_j : joints with the coupled free motions
    """

    joint_i: SpatialJoint
    joint_j: SpatialJoint

    unit = "m"
    """Unit of the shared motion."""

    def __post_init__(self) -> None:
        for joint in (self.joint_i, self.joint_j):
            if not isinstance(joint, SpatialJoint):
                raise ModelError(f"couples joints in space; got {joint!r}", self.name)
        if self.joint_i is self.joint_j and self.motions()[0] == self.motions()[1]:
            raise ModelError(f"couples {self.joint_i.name} to itself; give two", self.name)
        self._shared = SharedMotion(self.name, self.unit)
        super().__post_init__()

    def motions(self) -> tuple[str | None, str | None]:
        """Names of the motions if the joints have several."""
        return None, None

    @property
    def shared(self) -> ca.SX:
        """``u``."""
        return self._shared.pose[0]

    def own_coordinates(self) -> list[Coordinates]:
        return [self._shared]

    def ends(self) -> tuple[BodyElement, BodyElement]:
        return self.joint_i.ends()[1], self.joint_j.ends()[1]

    def parts(self) -> list[Coordinates]:
        bodies = (*self.joint_i.parts(), *self.joint_j.parts())
        return [*dict.fromkeys(bodies), self._shared]

    def place(self) -> ca.SX:
        return self.joint_j.place()


@dataclass(eq=False)
class Coupling(CoupledJoints):
    """Fixed ratio between motions of two joints, each a rotation or a displacement.

    A gearbox, belt or cable: ``Φ = [s_i − u; s_j − ratio u] = 0``, measured from the initial poses.
    The last multiplier is minus the torque or force on the second motion.

    Parameters
    ----------
    ratio : motion of the second joint per motion of the first
    motion_i, motion_j : names of the motions if a joint has several

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("lead")
    >>> motor, nut = system.add(spatial.Body("motor")), system.add(spatial.Body("nut"))
    >>> turn = system.add(spatial.Revolute("O", system.ground.frame(), motor.frame()))
    >>> slide = system.add(spatial.Prismatic("rail", system.ground.frame(), nut.frame()))
    >>> lead = system.add(spatial.Coupling("lead", turn, slide, ratio=0.01 / (2 * math.pi)))
    >>> drive = system.add(spatial.RotationalDriver("drive", turn, 4 * math.pi * da.t))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=1.0)
    >>> motion["nut.z"].values.round(6)  # two revolutions of 10 mm
    array([0.  , 0.02])
    """

    ratio: Scalar = quantity(
        "1 | m/rad | rad/m", "motion of the second joint per motion of the first", default=1.0
    )
    motion_i: str = option("which motion of the first joint", default=None)
    motion_j: str = option("which motion of the second joint", default=None)

    def __post_init__(self) -> None:
        self.unit = self._units()[0] if isinstance(self.joint_i, SpatialJoint) else "m"
        super().__post_init__()

    def motions(self) -> tuple[str | None, str | None]:
        return self.motion_i, self.motion_j

    def residual(self) -> ca.SX:
        values = (self.shared, self.ratio.sx * self.shared)
        joints = (self.joint_i, self.joint_j)
        deviations = {"rad": turn_deviation, "m": travel_deviation}
        return ca.vertcat(
            *(
                deviations[unit](joint, motion, value, self.name)
                for joint, motion, unit, value in zip(
                    joints, self.motions(), self._units(), values, strict=True
                )
            )
        )

    def look(self) -> list[Look]:
        if self._units() == ["rad", "rad"] and self.carrier is not None:
            return [Belt(*self.ends(), self.ratio.sx, self.carrier)]
        return [Tie(self.joint_i.end, self.joint_j.end)]

    @property
    def carrier(self) -> BodyElement | None:
        """The body that carries both joints, or None."""
        first, second = (joint.ends()[0] for joint in (self.joint_i, self.joint_j))
        return first if first is second else None

    def units(self) -> list[str]:
        return self._units()

    def _units(self) -> list[str]:
        units = []
        for joint, motion in zip((self.joint_i, self.joint_j), self.motions(), strict=True):
            free = joint.freedoms() if isinstance(joint, SpatialJoint) else {}
            name = free_motion(joint, free, motion, self.name)
            units.append(free[name][1])
        return units


@dataclass(eq=False)
class GearPair(CoupledJoints):
    """Two gears in mesh, in joints on a common carrier with axes at any angle.

    ``Φ = [r_i turn_i − u; r_j turn_j ± u] = 0``, + if the gears rotate in opposite directions about
    their axes, − with ``internal``; u is the travel of the pitch circles. The axes of the joints
    define the positive directions. Spur and bevel gears have their pitch radii; a worm has its
    lead divided by 2π. The measure ``tooth_force`` is that along the pitch circles. Bearing loads
    from the teeth other than the moments of the gears are neglected.

    Parameters
    ----------
    joint_i, joint_j : joints of the gears on the carrier, each with a free rotation
    radius_i, radius_j : pitch radii [m]
    internal : both gears rotate in the same direction

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("bevel gears")
    >>> a, b = system.add(spatial.Body("a")), system.add(spatial.Body("b"))
    >>> side = dict(axis=(1, 0, 0))
    >>> i = system.add(spatial.Revolute("A", system.ground.frame(), a.frame()))
    >>> j = system.add(spatial.Revolute("B", system.ground.frame(**side), b.frame(**side)))
    >>> mesh = system.add(spatial.GearPair("mesh", i, j, radius_i=0.02, radius_j=0.06))
    >>> drive = system.add(spatial.RotationalDriver("drive", i, 6 * da.t))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=1.0)
    >>> round(motion["B.angle_rate"][0].item(), 6)  # opposite, by the ratio of the radii
    -2.0
    """

    radius_i: Scalar = quantity("m", "pitch radius of the first gear", above=0.0, keyword=True)
    radius_j: Scalar = quantity("m", "pitch radius of the second gear", above=0.0, keyword=True)
    internal: bool = option("both gears rotate in the same direction", default=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        bodies = [set(joint.ends()) for joint in (self.joint_i, self.joint_j)]
        if not bodies[0] & bodies[1]:
            raise ModelError(
                f"{self.joint_i.name} and {self.joint_j.name} have no body in common that carries "
                "both gears; put both hinges on one carrier",
                self.name,
            )

    def residual(self) -> ca.SX:
        i, j, sign = self.radius_i.sx, self.radius_j.sx, 1 if self.internal else -1
        return ca.vertcat(
            i * turn_deviation(self.joint_i, None, self.shared / i, self.name),
            j * turn_deviation(self.joint_j, None, sign * self.shared / j, self.name),
        )

    def look(self) -> list[Look]:
        (i, r), (j, q) = (self.joint_i.end, self.radius_i.sx), (self.joint_j.end, self.radius_j.sx)
        return [Disc(i, r), Disc(j, q), Mesh(j, i, q, r, self.internal)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        return {"tooth_force": (self.multiplier[0], "N")}


@dataclass(eq=False)
class RackAndPinion(CoupledJoints):
    """A pinion in one joint drives a rack in another, without slip.

    ``Φ = [r turn_i − u; displacement_j − side u] = 0``, measured from the initial poses. The axes
    of the joints define the positive directions. The measure ``tooth_force`` is the force along the
    rack.

    Parameters
    ----------
    joint_i, joint_j : joints of the pinion, with a free rotation, and of the rack, with a free
        displacement
    radius : pitch radius [m]
    side : +1 if a positive rotation of the pinion moves the rack along its axis, else −1

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("steering")
    >>> pinion, rack = system.add(spatial.Body("pinion")), system.add(spatial.Body("rack"))
    >>> hinge = system.add(spatial.Revolute("O", system.ground.frame(), pinion.frame()))
    >>> along = dict(axis=(1, 0, 0))
    >>> ends = system.ground.frame(**along), rack.frame(**along)
    >>> rail = system.add(spatial.Prismatic("rail", *ends))
    >>> mesh = system.add(spatial.RackAndPinion("mesh", hinge, rail, radius=0.02))
    >>> wheel = system.add(spatial.RotationalDriver("wheel", hinge, da.t))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=1.0)
    >>> motion["rack.x"].values.round(6)  # r φ
    array([0.  , 0.02])
    """

    radius: Scalar = quantity("m", "pitch radius", above=0.0, keyword=True)
    side: int = option("+1 or -1: sense of the rack's travel", default=1)

    def __post_init__(self) -> None:
        if self.side not in (1, -1):
            raise ModelError(f"side must be 1 or -1, got {self.side!r}", self.name)
        super().__post_init__()

    def residual(self) -> ca.SX:
        r = self.radius.sx
        return ca.vertcat(
            r * turn_deviation(self.joint_i, None, self.shared / r, self.name),
            travel_deviation(self.joint_j, None, self.side * self.shared, self.name),
        )

    def look(self) -> list[Look]:
        pinion, rack, axis = self.joint_i, self.joint_j, slide_of(self.joint_j, None, self.name)
        rail = Rail(rack.frame_i, rack.frame_i.local_axes[:, axis], rack.travel[axis])
        return [Disc(pinion.end, self.radius.sx), rail, Tie(pinion.end, rack.end)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        return {"tooth_force": (self.multiplier[0], "N")}
