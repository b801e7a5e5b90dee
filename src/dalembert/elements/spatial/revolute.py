"""Revolute joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.look import Pin
from dalembert.elements.spatial.joint import FrameJoint
from dalembert.elements.spatial.tree_joint import TreeJoint, opened_tilt
from dalembert.elements.spatial.turn import Turn
from dalembert.symbolic import rotation


@dataclass(eq=False)
class Revolute(FrameJoint, TreeJoint):
    """Hinge: two origins coincide and the z axes are parallel.

    ``Φ = [r_j − r_i; x_iᵀ z_j; y_iᵀ z_j] = 0``.
    """

    def residual(self) -> ca.SX:
        return ca.vertcat(self.between, self.tilt)

    def look(self) -> list[Look]:
        return [Pin(self.frame_j, self.frame_i)]

    def facing(self) -> ca.SX:
        return self.parallel

    def units(self) -> list[str]:
        return ["m", "m", "m", "rad", "rad"]

    def turns(self) -> dict[str, Turn]:
        return {"angle": self.turn}

    # as a carrier -----------------------------------------------------------------------------
    def turned(self, q: ca.SX) -> ca.SX:
        return rotation.about_z(self.first_turn + q)

    def subspace(self, q: ca.SX, axes_i: ca.SX, axes_j: ca.SX) -> ca.SX:
        return ca.vertcat(ca.SX(3, 1), axes_i[:, 2])

    def opened(self, q: ca.SX, axes_i: ca.SX, axes_j: ca.SX) -> ca.SX:
        return ca.diagcat(ca.SX.eye(3), opened_tilt(axes_i, axes_j))
