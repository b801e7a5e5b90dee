"""Gears, racks and belts in space: motions of two joints in a fixed ratio.

The motion that both share is a coordinate ``u`` of its own without mass, counted from the initial
poses: ``Φ = [s_i − a_i u; s_j − a_j u] = 0``. So the ratio holds over any number of turns, though
poses tell an angle but for full ones.
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
from dalembert.elements.spatial.joint import SpatialJoint, slide_of, turn_of
from dalembert.elements.spatial.turn import Turn
from dalembert.errors import ModelError


class SharedMotion(Coordinates):
    """How far two coupled joints have moved: one coordinate without mass."""

    def __init__(self, name: str, unit: str):
        self.name = f"{name}.shared"
        self.make_symbols(("u",), (unit,))

    def guesses(self) -> tuple[list, list]:
        return [ca.SX(0)], [None]


def turn_missed(joint: SpatialJoint, motion: str | None, angle: ca.SX, owner: str) -> ca.SX:
    """By how much a turn, counted from the initial poses, is off an angle; below half a turn."""
    turn = turn_of(joint, motion, owner)
    start = initial_value(turn.pair, joint.ends()).sx
    return turn.after(Turn(*ca.vertsplit(start))).after(Turn.of(angle)).angle


def travel_missed(joint: SpatialJoint, motion: str | None, travel: ca.SX, owner: str) -> ca.SX:
    """By how much a displacement, counted from the initial poses, is off a travel."""
    along = joint.travel[slide_of(joint, motion, owner)]
    return along - initial_value(along, joint.ends()).sx - travel


@dataclass(eq=False)
class CoupledJoints(Pair, Constraint):
    """A fixed ratio between the motions of two joints.

    Its reaction is that on the second body of the second joint.

    Parameters
    ----------
    joint_i, joint_j : joints that leave the motions free
    """

    joint_i: SpatialJoint
    joint_j: SpatialJoint

    unit = "m"
    """Of the shared motion."""

    def __post_init__(self) -> None:
        for joint in (self.joint_i, self.joint_j):
            if not isinstance(joint, SpatialJoint):
                raise ModelError(f"couples joints in space; got {joint!r}", self.name)
        if self.joint_i is self.joint_j and self.motions()[0] == self.motions()[1]:
            raise ModelError(f"couples {self.joint_i.name} to itself; give two", self.name)
        self._shared = SharedMotion(self.name, self.unit)
        super().__post_init__()

    def motions(self) -> tuple[str | None, str | None]:
        """Names of the motions, where the joints have several."""
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
    """Fixed ratio between motions of two joints, each a turn or a displacement.

    A gearbox, belt or cable: ``Φ = [s_i − u; s_j − ratio u] = 0``, counted from the initial poses.
    The last multiplier is minus the torque or force on the second motion.

    Parameters
    ----------
    ratio : motion of the second joint per motion of the first
    motion_i, motion_j : which motions, where a joint has several

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
    >>> motion["nut.z"].values.round(6)  # two turns of 10 mm
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
        asked = (self.shared, self.ratio.sx * self.shared)
        pairs = zip((self.joint_i, self.joint_j), self.motions(), self._units(), asked, strict=True)
        return ca.vertcat(
            *(
                (turn_missed if unit == "rad" else travel_missed)(joint, motion, value, self.name)
                for joint, motion, unit, value in pairs
            )
        )

    def look(self) -> list[Look]:
        if self._units() == ["rad", "rad"] and self.carrier is not None:
            return [Belt(*self.ends(), self.ratio.sx, self.carrier)]
        return [Tie(self.joint_i.end, self.joint_j.end)]

    @property
    def carrier(self) -> BodyElement | None:
        """The body that carries both joints, if one does."""
        first, second = (joint.ends()[0] for joint in (self.joint_i, self.joint_j))
        return first if first is second else None

    def units(self) -> list[str]:
        return self._units()

    def _units(self) -> list[str]:
        found = []
        for joint, motion in zip((self.joint_i, self.joint_j), self.motions(), strict=True):
            free = joint.freedoms() if isinstance(joint, SpatialJoint) else {}
            name = free_motion(joint, free, motion, self.name)
            found.append(free[name][1])
        return found


@dataclass(eq=False)
class GearPair(CoupledJoints):
    """Two gears in mesh, on hinges of a common carrier with axes at any angle.

    ``Φ = [r_i turn_i − u; r_j turn_j ± u] = 0``, + if a turn of one about its axis turns the other
    against its own, − with ``internal``; u is the travel of the pitch circles. The axes of the
    hinges say which way is positive. Spur and bevel gears have their pitch radii; a worm has its
    lead divided by 2π. The measure ``tooth_force`` is that along the pitch circles; what the teeth
    do to the bearings beside the moments of the gears is left out.

    Parameters
    ----------
    joint_i, joint_j : joints of the gears on the carrier; a turn is free in both
    radius_i, radius_j : pitch radii [m]
    internal : the second gear turns with the first

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
    >>> round(motion["B.angle_rate"][0].item(), 6)  # against it, by the ratio of the radii
    -2.0
    """

    radius_i: Scalar = quantity("m", "pitch radius of the first gear", above=0.0, keyword=True)
    radius_j: Scalar = quantity("m", "pitch radius of the second gear", above=0.0, keyword=True)
    internal: bool = option("the second gear turns with the first", default=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        carried = [set(joint.ends()) for joint in (self.joint_i, self.joint_j)]
        if not carried[0] & carried[1]:
            raise ModelError(
                f"{self.joint_i.name} and {self.joint_j.name} have no body in common that carries "
                "both gears; put both hinges on one carrier",
                self.name,
            )

    def residual(self) -> ca.SX:
        i, j, sense = self.radius_i.sx, self.radius_j.sx, 1 if self.internal else -1
        return ca.vertcat(
            i * turn_missed(self.joint_i, None, self.shared / i, self.name),
            j * turn_missed(self.joint_j, None, sense * self.shared / j, self.name),
        )

    def look(self) -> list[Look]:
        (i, r), (j, q) = (self.joint_i.end, self.radius_i.sx), (self.joint_j.end, self.radius_j.sx)
        return [Disc(i, r), Disc(j, q), Mesh(j, i, q, r, self.internal)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        return {"tooth_force": (self.multiplier[0], "N")}


@dataclass(eq=False)
class RackAndPinion(CoupledJoints):
    """A pinion that turns in one joint moves a rack that slides in another, without slip.

    ``Φ = [r turn_i − u; displacement_j − side u] = 0``, counted from the initial poses. The axes of
    the joints say which way is positive. The measure ``tooth_force`` is that along the rack.

    Parameters
    ----------
    joint_i, joint_j : joint of the pinion, with a free turn, and of the rack, with a displacement
    radius : pitch radius [m]
    side : +1 if the rack moves up its axis when the pinion turns up its own, else −1

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
            r * turn_missed(self.joint_i, None, self.shared / r, self.name),
            travel_missed(self.joint_j, None, self.side * self.shared, self.name),
        )

    def look(self) -> list[Look]:
        pinion, rack, axis = self.joint_i, self.joint_j, slide_of(self.joint_j, None, self.name)
        along = Rail(rack.frame_i, rack.frame_i.local_axes[:, axis], rack.travel[axis])
        return [Disc(pinion.end, self.radius.sx), along, Tie(pinion.end, rack.end)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        return {"tooth_force": (self.multiplier[0], "N")}
