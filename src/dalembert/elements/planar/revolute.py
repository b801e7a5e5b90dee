"""Planar revolute joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.look import Pin
from dalembert.elements.planar.joint import TreeJoint


@dataclass(eq=False)
class Revolute(TreeJoint):
    """Revolute joint: two points coincide, ``Φ = r_j + A_j s_j' − r_i − A_i s_i' = 0`` (1.18).

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -9.81))
    >>> bob = system.add(planar.Bar("bob", length=1.0, mass=2.0, angle=-0.5))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bob.start))
    >>> model = system.build()
    >>> model.diagnosis.degrees_of_freedom
    1
    >>> rest = da.solve_equilibrium(model)
    >>> round(rest["O.force.y"].item(), 6)  # on the second body: its weight
    19.62
    """

    def residual(self) -> ca.SX:
        return self.between

    def look(self) -> list[Look]:
        return [Pin(self.point_j, self.point_i)]

    def opening(self, q: ca.SX, z: ca.SX, angle_i: ca.SX) -> ca.SX:
        return z

    def freedoms(self) -> dict[str, tuple[ca.SX, str]]:
        return self.turning
