"""Spherical joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.look import Socket
from dalembert.elements.pair import PointJoint


@dataclass(eq=False)
class Spherical(PointJoint):
    """Ball and socket: two points coincide, ``Φ = r_jP − r_iP = 0``."""

    def look(self) -> list[Look]:
        return [Socket(self.point_j, self.point_i)]

    def residual(self) -> ca.SX:
        return self.between
