"""Polynomial and harmonic motion laws."""

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


@dataclass(eq=False)
class Harmonic(Law):
    """``f = mean + amplitude · sin(frequency · t + phase)``, frequency in rad/s.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("shaker")
    >>> table = system.add(planar.Body("table", mass=2.0, inertia=0.1))
    >>> rail = system.add(planar.Translational("rail", system.ground.center, table.center))
    >>> swing = da.Harmonic(amplitude=0.01, frequency=20.0, phase="90 deg")
    >>> drive = system.add(planar.CoordinateDriver("drive", table.center, swing))
    >>> motion = da.solve_inverse_dynamics(system.build(), 1.0, step=0.5)
    >>> round(motion["drive.effort"][0].item(), 6)  # -m ω² a
    -8.0
    """

    amplitude: Scalar = quantity("m | rad", "amplitude")
    frequency: Scalar = quantity("rad/s", "angular frequency")
    mean: Scalar = quantity("m | rad", "mean value", default=0.0)
    phase: Scalar = quantity("rad", "phase at t = 0", default=0.0)

    def value(self, time: ca.SX) -> ca.SX:
        return self.mean.sx + self.amplitude.sx * ca.sin(self.frequency.sx * time + self.phase.sx)
