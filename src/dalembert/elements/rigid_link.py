"""Massless rigid link between two points."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look, Scalar, quantity
from dalembert.elements.look import Rod
from dalembert.elements.pair import PointJoint


@dataclass(eq=False)
class ConstantDistance(PointJoint):
    """Constant distance between two points, ``Φ = |r_jP − r_iP| − length``.

    The multiplier is the force in the link [N], positive in tension.

    Parameters
    ----------
    length : distance of the points [m]
    """

    length: Scalar = quantity("m", "distance of the two points", above=0.0, keyword=True)

    def residual(self) -> ca.SX:
        distance, length = self.compared()
        return distance - length

    def look(self) -> list[Look]:
        return [Rod(self.point_i, self.point_j)]

    def compared(self) -> tuple[ca.SX, ca.SX]:
        return self.distance, self.length.sx
