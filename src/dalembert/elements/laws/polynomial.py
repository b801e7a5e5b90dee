"""Uniform and uniformly accelerated motion."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.laws.base import Law


@dataclass(eq=False)
class Polynomial(Law):
    """``f = ½ α t² + ω t + φ0`` (1.28)."""

    start: Scalar = quantity("m | rad", "value at t = 0", default=0.0)
    velocity: Scalar = quantity("m/s | rad/s", "velocity at t = 0", default=0.0)
    acceleration: Scalar = quantity("m/s^2 | rad/s^2", "constant acceleration", default=0.0)

    def value(self, time: ca.SX) -> ca.SX:
        return self.start.sx + self.velocity.sx * time + self.acceleration.sx * time**2 / 2
