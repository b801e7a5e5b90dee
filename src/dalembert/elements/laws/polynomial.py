"""Uniform and uniformly accelerated motion."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.laws.base import Law


@dataclass(eq=False)
class Polynomial(Law):
    """``f = ½ α t² + ω t + φ0`` (1.28).

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("run-up")
    >>> crank = system.add(planar.Bar("crank", length=0.2))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, crank.start))
    >>> law = da.Polynomial(velocity="30 rpm", acceleration=2.0)
    >>> motor = system.add(planar.RotationalDriver("motor", system.ground, crank, law))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=1.0)
    >>> motion["crank.angular_velocity"].values.round(6)  # π and 2 more
    array([3.141593, 5.141593])
    """

    start: Scalar = quantity("m | rad", "value at t = 0", default=0.0)
    velocity: Scalar = quantity("m/s | rad/s", "velocity at t = 0", default=0.0)
    acceleration: Scalar = quantity("m/s^2 | rad/s^2", "constant acceleration", default=0.0)

    def value(self, time: ca.SX) -> ca.SX:
        return self.start.sx + self.velocity.sx * time + self.acceleration.sx * time**2 / 2
