"""Planar rigid connection of two bodies."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look, Scalar, quantity
from dalembert.elements.look import Clamp
from dalembert.elements.planar.joint import TreeJoint


@dataclass(eq=False)
class Weld(TreeJoint):
    """Rigid connection: two points coincide and the relative rotation is fixed.

    ``Φ = [r_jP − r_iP; φ_j − φ_i − angle] = 0``; with the ground this is (1.27).

    Parameters
    ----------
    angle : angle of the second body relative to the first [rad]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("bracket", gravity=(0, -10))
    >>> arm = system.add(planar.Bar("arm", length=1.2, mass=3.0))
    >>> wall = system.add(planar.Weld("wall", system.ground.center, arm.start))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["wall.moment"].item(), 6), round(rest["wall.force.y"].item(), 6)  # m g l/2, m g
    (18.0, 30.0)
    """

    angle: Scalar = quantity("rad", "angle of the second body relative to the first", default=0.0)

    def residual(self) -> ca.SX:
        return ca.vertcat(self.between, self.turn - self.angle.sx)

    def look(self) -> list[Look]:
        return [Clamp(self.point_j, self.point_i)]

    def fixed_turn(self, z: ca.SX) -> ca.SX:
        return self.angle.sx + z[2]

    def opening(self, q: ca.SX, z: ca.SX, angle_i: ca.SX) -> ca.SX:
        return z[:2]

    def units(self) -> list[str]:
        return ["m", "m", "rad"]
