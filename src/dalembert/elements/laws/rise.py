"""Rises with dwell: the standard cam laws, single or repeated rise–dwell–return–dwell.

The profile ``s(x)`` rises from 0 at ``x = 0`` to 1 at ``x = 1`` and is constant outside. With
``fall`` the motion returns after ``dwell``; with ``period`` it repeats.
Source: R. L. Norton, *Cam Design and Manufacturing Handbook*, ch. 2-3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Scalar, quantity
from dalembert.elements.laws.base import Law


@dataclass(eq=False)
class Rise(Law):
    """``f = start + height · s((t − begin)/duration)`` with the profile ``s`` of the subclass."""

    height: Scalar = quantity("m | rad", "rise from start to dwell")
    duration: Scalar = quantity("s", "time of the rise", above=0.0)
    start: Scalar = quantity("m | rad", "value before the rise", default=0.0)
    begin: Scalar = quantity("s", "time at which the rise begins", default=0.0)
    dwell: Scalar = quantity("s", "time at the top before the return", default=0.0, minimum=0.0)
    fall: Scalar = quantity("s", "time of the return; none: stay on top", default=None, above=0.0)
    period: Scalar = quantity("s", "repeat after this time; none: once", default=None, above=0.0)

    def profile(self, x: ca.SX) -> ca.SX:
        raise NotImplementedError

    def value(self, time: ca.SX) -> ca.SX:
        local = time - self.begin.sx
        if self.period is not None:
            local = local - self.period.sx * ca.floor(local / self.period.sx)
        height = self._clipped(local / self.duration.sx)
        if self.fall is not None:
            after = local - self.duration.sx - self.dwell.sx
            height = height - self._clipped(after / self.fall.sx)
        return self.start.sx + self.height.sx * height

    def conditions(self) -> list[Condition]:
        if self.period is None:
            return []
        if self.fall is None:
            return [(ca.SX(-1), "a law with a period must return; give fall=")]
        total = self.duration.sx + self.dwell.sx + self.fall.sx
        text = "duration + dwell + fall exceed the period; lengthen it"
        return [(self.period.sx - total + 1e-12 * self.period.sx, text)]

    def _clipped(self, x: ca.SX) -> ca.SX:
        inside = self.profile(x)
        return ca.if_else(x <= 0, 0, ca.if_else(x >= 1, 1, inside))


@dataclass(eq=False)
class HarmonicRise(Rise):
    """``s = (1 − cos πx)/2``: acceleration jumps at both ends.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("gripper")
    >>> jaw = system.add(planar.Body("jaw"))
    >>> rail = system.add(planar.Prismatic("rail", system.ground.center, jaw.center))
    >>> lift = da.HarmonicRise(height=0.1, duration=1.0)
    >>> cam = system.add(planar.CoordinateDriver("cam", jaw.center, lift))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=0.5)
    >>> round(motion["jaw.vx"][1].item(), 6)  # π h/(2 T) at half time
    0.15708
    """

    def profile(self, x: ca.SX) -> ca.SX:
        return (1 - ca.cos(math.pi * x)) / 2


@dataclass(eq=False)
class CycloidalRise(Rise):
    """``s = x − sin(2πx)/2π``: acceleration zero at both ends.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("cam follower")
    >>> follower = system.add(planar.Body("follower"))
    >>> rail = system.add(planar.Prismatic("rail", system.ground.center, follower.center))
    >>> lift = da.CycloidalRise(height=0.02, duration=0.5)
    >>> cam = system.add(planar.CoordinateDriver("cam", follower.center, lift))
    >>> motion = da.solve_kinematics(system.build(), 0.5, step=0.25)
    >>> motion["follower.x"].values.round(6)
    array([0.  , 0.01, 0.02])
    >>> round(motion["follower.vx"][1].item(), 6)  # 2 h/T in the middle
    0.08
    """

    def profile(self, x: ca.SX) -> ca.SX:
        return x - ca.sin(2 * math.pi * x) / (2 * math.pi)


@dataclass(eq=False)
class Polynomial345Rise(Rise):
    """``s = 10x³ − 15x⁴ + 6x⁵``: acceleration zero at both ends.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("valve")
    >>> valve = system.add(planar.Body("valve"))
    >>> guide = planar.Prismatic("guide", system.ground.center, valve.center, axis=(0, 1))
    >>> rail = system.add(guide)
    >>> lift = da.Polynomial345Rise(height=0.01, duration=0.1, dwell=0.05, fall=0.1, period=0.4)
    >>> cam = planar.CoordinateDriver("cam", valve.center, lift, direction=(0, 1))
    >>> driver = system.add(cam)
    >>> motion = da.solve_kinematics(system.build(), 0.4, step=0.05)
    >>> (motion["valve.y"].values[:6] * 1e3).round(3) + 0.0  # [mm]: up, dwell, down
    array([ 0.,  5., 10., 10.,  5.,  0.])
    """

    def profile(self, x: ca.SX) -> ca.SX:
        return x**3 * (10 + x * (-15 + 6 * x))


@dataclass(eq=False)
class Polynomial4567Rise(Rise):
    """``s = 35x⁴ − 84x⁵ + 70x⁶ − 20x⁷``: acceleration and jerk zero at both ends.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("indexing table")
    >>> table = system.add(planar.Body("table"))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, table.center))
    >>> turn = da.Polynomial4567Rise(height="90 deg", duration=0.4)
    >>> motor = system.add(planar.RotationalDriver("motor", system.ground, table, turn))
    >>> motion = da.solve_kinematics(system.build(), 0.4, step=0.2)
    >>> round(motion["table.angular_velocity"][1].item() * 0.4 / (math.pi / 2), 6)  # 35/16
    2.1875
    """

    def profile(self, x: ca.SX) -> ca.SX:
        return x**4 * (35 + x * (-84 + x * (70 - 20 * x)))
