"""Revolute joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.look import Pin
from dalembert.elements.spatial.axial_joint import AxialJoint
from dalembert.elements.spatial.turn import Turn


@dataclass(eq=False)
class Revolute(AxialJoint):
    """Hinge: two origins coincide and the z axes are parallel.

    ``Φ = [r_j − r_i; x_iᵀ z_j; y_iᵀ z_j] = 0``.
    """

    def residual(self) -> ca.SX:
        return ca.vertcat(self.between, self.tilt)

    def look(self) -> list[Look]:
        return [Pin(self.frame_j, self.frame_i)]

    def units(self) -> list[str]:
        return ["m", "m", "m", "rad", "rad"]

    def turns(self) -> dict[str, Turn]:
        return {"angle": self.turn}
