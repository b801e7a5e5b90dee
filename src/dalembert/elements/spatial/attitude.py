"""Orientation as coordinates: Euler parameters."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.coordinates import Coordinates
from dalembert.symbolic import rotation
from dalembert.symbolic.formulas.expression import stack


class Attitude(Coordinates):
    """A rotation by Euler parameters, ``ė = e ⊗ (0, ω') / 2``.

    Parameters
    ----------
    name : str
    """

    flat = False
    rest = rotation.IDENTITY
    coordinate_names, coordinate_units = rotation.EULER_PARAMETERS, ("1",) * 4
    speed_names, speed_units = rotation.SPIN, ("rad",) * 3

    def __init__(self, name: str):
        self.name = name
        self.pose = stack(ca.SX.sym(f"{name}.{n}") for n in self.coordinate_names)
        self._make_speeds()
        self.pose_rate = rotation.rate(self.pose, self.twist)

    def retract(self, pose: ca.SX, displacement: ca.SX) -> ca.SX:
        return rotation.turned(pose, displacement)

    def displacement(self, pose: ca.SX, other: ca.SX) -> ca.SX:
        return rotation.turn(pose, other)

    def bounds(self, pose: ca.SX) -> ca.SX:
        return (ca.sumsqr(pose) - 1) / 2
