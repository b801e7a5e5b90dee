"""Planar applied loads."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, Vector, option, quantity
from dalembert.elements.loads import Couple, PointForce
from dalembert.elements.planar.body import Body
from dalembert.elements.planar.joint import InPlane


@dataclass(eq=False)
class Force(InPlane, PointForce):
    """Force at a point of a body (1.53).

    Parameters
    ----------
    point : point of application
    vector : (2,) components [N]; formulas of t, parameters and measures are allowed
    following : the components are in the body frame; otherwise in inertial axes

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("swing")
    >>> bar = system.add(planar.Bar("bar", length=1.0, mass=3.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bar.start))
    >>> push = system.add(planar.Force("push", bar.end, (0, 2 * da.cos(da.t))))
    >>> motion = da.solve_dynamics(system.build(), 0.01, step=0.01)
    >>> round(motion["bar.angular_acceleration"][0].item(), 6)  # F l over m l²/3
    2.0
    """

    vector: Vector = quantity("N", "components", size=2)
    following: bool = option("components turn with the body", default=False)

    def axes(self) -> Body | None:
        return self.point.body if self.following else None


@dataclass(eq=False)
class Torque(InPlane, Couple):
    """Moment on a body (1.55), with its reaction on an optional second one: a rotary actuator.

    Parameters
    ----------
    body : body it acts on
    value : [N m]; formulas of t, parameters and measures are allowed
    reaction_on : body that carries the reaction; the ground by default

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("flywheel")
    >>> wheel = system.add(planar.Body("wheel", mass=5.0, inertia=0.2))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, wheel.center))
    >>> torque = system.add(planar.Torque("torque", wheel, 4 * da.t))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> round(motion["wheel.angular_velocity"][-1].item(), 6)  # its integral over the inertia
    10.0
    """

    body: Body
    value: Scalar = quantity("N m", "moment")
    reaction_on: Body = option("body that carries the reaction", default=None)

    @property
    def turning(self) -> ca.SX:
        return super().turning[2]

    def components(self) -> ca.SX:
        return self.value.sx
