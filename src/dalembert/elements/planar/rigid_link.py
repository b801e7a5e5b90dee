"""Planar massless rigid link with a pin at each end."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.pair import ConstantDistance
from dalembert.elements.planar.joint import TreeJoint


@dataclass(eq=False)
class RigidLink(ConstantDistance, TreeJoint):
    """Constant distance between two points (revolute–revolute), ``Φ = |r_jP − r_iP| − length``.

    The multiplier is the force in the link [N], positive in tension.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -9.81))
    >>> bob = system.add(planar.Particle("bob", mass=2.0, position=(0.1, -0.9)))
    >>> rod = system.add(planar.RigidLink("rod", system.ground.center, bob.center, length=1.0))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["bob.y"].item(), 6), round(rest["rod.force_norm"].item(), 6)  # -l, m g
    (-1.0, 19.62)
    """

    def joint_coordinates(self) -> dict[str, tuple[ca.SX, str]]:
        return {"direction": (ca.atan2(self.between[1], self.between[0]), "rad")}

    def opening(self, q: ca.SX, z: ca.SX, angle_i: ca.SX) -> ca.SX:
        return (self.length.sx + z) * ca.vertcat(ca.cos(q), ca.sin(q))
