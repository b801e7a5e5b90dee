"""Harmonic oscillation."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.laws.base import Law


@dataclass(eq=False)
class Harmonic(Law):
    """``f = mean + amplitude · sin(frequency · t + phase)``, frequency in rad/s."""

    amplitude: Scalar = quantity("m | rad", "amplitude")
    frequency: Scalar = quantity("rad/s", "angular frequency")
    mean: Scalar = quantity("m | rad", "mean value", default=0.0)
    phase: Scalar = quantity("rad", "phase at t = 0", default=0.0)

    def value(self, time: ca.SX) -> ca.SX:
        return self.mean.sx + self.amplitude.sx * ca.sin(self.frequency.sx * time + self.phase.sx)
