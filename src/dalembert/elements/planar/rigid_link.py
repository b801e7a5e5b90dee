"""Massless rigid link with a pin at each end."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look, Scalar, quantity
from dalembert.elements.look import Rod
from dalembert.elements.planar.joint import TreeJoint


@dataclass(eq=False)
class RigidLink(TreeJoint):
    """Constant distance between two points (revolute–revolute), ``Φ = |r_jP − r_iP| − length``.

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

    def joint_coordinates(self) -> dict[str, tuple[ca.SX, str]]:
        return {"direction": (ca.atan2(self.between[1], self.between[0]), "rad")}

    def opening(self, q: ca.SX, z: ca.SX, angle_i: ca.SX) -> ca.SX:
        return (self.length.sx + z) * ca.vertcat(ca.cos(q), ca.sin(q))
