"""Massless rigid link with a pin at each end."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.planar.joint import TreeJoint
from dalembert.elements.rigid_link import ConstantDistance


@dataclass(eq=False)
class RigidLink(ConstantDistance, TreeJoint):
    """Constant distance between two points (revolute–revolute), ``Φ = |r_jP − r_iP| − length``.

    The multiplier is the force in the link [N], positive in tension.
    """

    def joint_coordinates(self) -> dict[str, tuple[ca.SX, str]]:
        return {"direction": (ca.atan2(self.between[1], self.between[0]), "rad")}

    def opening(self, q: ca.SX, z: ca.SX, angle_i: ca.SX) -> ca.SX:
        return (self.length.sx + z) * ca.vertcat(ca.cos(q), ca.sin(q))
