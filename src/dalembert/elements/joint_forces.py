"""Friction and actuators in joints: forces along a free motion of a joint."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.base import (
    Constraint,
    ForceElement,
    Look,
    Powers,
    Rate,
    Scalar,
    option,
    quantity,
)
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Cylinder, Motor
from dalembert.elements.pair import Pair
from dalembert.errors import ModelError


def free_motion(
    joint: Any, free: Collection[str], motion: str | None, owner: str, kind: str = "motion"
) -> str:
    """Name of a free motion of a joint; the first one by default.

    Raises
    ------
    ModelError
        The joint has no free motion, or none of this name.
    """
    if not free:
        text = f"{type(joint).__name__} {joint.name}" if isinstance(joint, Constraint) else joint
        raise ModelError(f"joint must leave a {kind} free; got {text!s}", owner)
    if motion is not None and motion not in free:
        raise ModelError(f"{joint.name} has no {kind} {motion!r}; it has {', '.join(free)}", owner)
    return motion or next(iter(free))


class AlongJoint(ForceElement):
    """Force or moment along a free motion of a joint."""

    name: str
    joint: Constraint
    motion: str | None

    def __post_init__(self) -> None:
        super().__post_init__()
        free = self.joint.freedoms() if isinstance(self.joint, Constraint) else {}
        self.motion = free_motion(self.joint, free, self.motion, self.name)
        self.free_coordinate, self.free_unit = free[self.motion]

    def effort(self, speed: ca.SX) -> ca.SX:
        """Force or moment along the motion as a function of its speed."""
        raise NotImplementedError

    @property
    def rotor(self) -> ca.SX:
        """Inertia that moves with the free motion only [kg m²] or [kg]."""
        return ca.SX(0)

    def powers(self, rate: Rate) -> Powers:
        speed = rate(self.free_coordinate)
        return [(speed, self.effort(speed))]

    def inertial_powers(self, rate: Rate) -> Powers:
        if self.rotor.is_zero():
            return []
        speed = rate(self.free_coordinate)
        return [(speed, self.rotor * rate(speed))]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        speed, rotates = rate(self.free_coordinate), self.free_unit == "rad"
        return {
            "moment" if rotates else "force": (self.effort(speed), "N m" if rotates else "N"),
            "rate": (speed, f"{self.free_unit}/s"),
        }

    def parts(self) -> list[Coordinates]:
        return self.joint.parts()


@dataclass(eq=False)
class JointFriction(AlongJoint):
    """Friction along a free motion of a joint: smoothed Coulomb plus viscous.

    ``Q = −(coulomb · tanh(ṡ/transition) + viscous · ṡ)`` along the free coordinate ``s``.

    Parameters
    ----------
    joint : joint with a free motion
    coulomb : sliding friction force [N] or moment [N m]; may be a formula of positions and speeds
    viscous : [N s/m] or [N m s/rad]
    transition : speed at which 76 % of the Coulomb value is reached [m/s] or [rad/s]
    motion : name of the free motion if the joint has several (``displacement`` or ``angle``)

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sledge")
    >>> sledge = system.add(planar.Body("sledge", mass=2.0, inertia=0.1, velocity=(3, 0)))
    >>> rail = system.add(planar.Prismatic("rail", system.ground.center, sledge.center))
    >>> rub = system.add(planar.JointFriction("rub", rail, viscous=4.0))
    >>> motion = da.solve_dynamics(system.build(), 5.0, step=0.01)
    >>> round(motion["sledge.x"][-1].item(), 3)  # m v/c (1 - exp(-10))
    1.5
    """

    joint: Constraint
    coulomb: Scalar = quantity("N | N m", "sliding friction", default=0.0, minimum=0.0)
    viscous: Scalar = quantity("N s/m | N m s/rad", "viscous friction", default=0.0, minimum=0.0)
    transition: Scalar = quantity("m/s | rad/s", "smoothing speed", default=1e-3, above=0.0)
    motion: str = option("name of the free motion, if the joint has several", default=None)

    not_drawn = "it acts in a joint, which is drawn"

    def effort(self, speed: ca.SX) -> ca.SX:
        sliding = self.coulomb.sx * ca.tanh(speed / self.transition.sx)
        return -(sliding + self.viscous.sx * speed)

    def dissipation(self, rate: Rate) -> Powers:
        return self.powers(rate)


@dataclass(eq=False)
class JointActuator(AlongJoint):
    """Force or moment along a free motion ``s`` of a joint: a motor, a hydraulic cylinder.

    A rotor with a gear adds ``−J s̈``: of a motor with the moment of inertia ``J_m`` and the ratio
    ``n`` it is ``J = n² J_m``; gyroscopic effects of the rotor are neglected (Featherstone, Rigid
    Body Dynamics Algorithms, 2008, 9.6).

    Parameters
    ----------
    joint : joint with a free motion
    value : force [N] or moment [N m], positive increases the coordinate; formula of t, parameters
        and measures
    motion : name of the free motion if the joint has several (``displacement`` or ``angle``)
    inertia : ``J`` of a rotor, at the joint [kg m²] or [kg]

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
    motion: str = option("name of the free motion, if the joint has several", default=None)
    inertia: Scalar = quantity(
        "kg m^2 | kg", "inertia of a rotor, at the joint", default=0.0, minimum=0.0
    )
    not_drawn = "the motion it drives has no two points"

    @property
    def rotor(self) -> ca.SX:
        return self.inertia.sx

    def effort(self, speed: ca.SX) -> ca.SX:
        return self.value.sx

    def look(self) -> list[Look]:
        if self.free_unit == "rad" and isinstance(self.joint, Pair):
            return [Motor(*self.joint.ends())]
        end_points = self.joint.end_points
        return [] if end_points is None else [Cylinder(*end_points)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        power = self.value.sx * rate(self.free_coordinate)
        return {**super().measures(rate), "power": (power, "W")}
