"""Actuators in joints."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.along_joint import AlongJoint
from dalembert.elements.base import Constraint, Look, Rate, Scalar, option, quantity
from dalembert.elements.look import Cylinder, Motor
from dalembert.elements.pair import Pair


@dataclass(eq=False)
class JointActuator(AlongJoint):
    """Force or moment along a motion that a joint leaves free: a motor, a ram.

    Parameters
    ----------
    joint : joint that leaves a motion free
    value : force [N] or moment [N m], positive drives the motion up; formula of t, parameters and
        measures
    motion : which free motion, where the joint has several (``displacement`` or ``angle``)

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("arm")
    >>> arm = system.add(planar.Bar("arm", length=1.0, mass=3.0))
    >>> shoulder = system.add(planar.Revolute("O", system.ground.center, arm.start))
    >>> moment = 5.0 - 2.0 * arm.angular_velocity
    >>> motor = system.add(planar.JointActuator("motor", shoulder, moment))
    >>> motion = da.solve_dynamics(system.build(), 5.0, step=0.01)
    >>> round(motion["arm.angular_velocity"][-1].item(), 3)  # where the moment is zero
    2.5
    """

    joint: Constraint
    value: Scalar = quantity("N | N m", "force or moment, positive drives the motion up")
    motion: str = option("which free motion, where there are several", default=None)
    unseen = "the motion it drives has no two points"

    def effort(self, speed: ca.SX) -> ca.SX:
        return self.value.sx

    def look(self) -> list[Look]:
        if self.sliding_unit == "rad" and isinstance(self.joint, Pair):
            return [Motor(*self.joint.ends())]
        spots = self.joint.spots
        return [] if spots is None else [Cylinder(*spots)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        power = self.value.sx * rate(self.sliding)
        return {**super().measures(rate), "power": (power, "W")}
