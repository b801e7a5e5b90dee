"""Revolute joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.look import Pin
from dalembert.elements.spatial.axial_joint import AxialJoint
from dalembert.elements.spatial.frame_pair import Turn


@dataclass(eq=False)
class Revolute(AxialJoint):
    """Hinge: two origins coincide and the z axes are parallel.

    ``Φ = [r_j − r_i; x_iᵀ z_j; y_iᵀ z_j] = 0``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("door", gravity=(0, 0, -10))
    >>> door = system.add(spatial.Box("door", size=(0.9, 0.04, 2), mass=20.0))
    >>> hinge = spatial.Revolute("hinge", system.ground.frame(), door.frame((-0.45, 0, 0)))
    >>> joint = system.add(hinge)
    >>> pull = system.add(spatial.Torque("pull", door, (0, 0, 5.402667)))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> round(motion["hinge.angle"][-1].item(), 6)  # M t²/2 by m (a² + b²)/12 + m a²/4
    0.5
    """

    def residual(self) -> ca.SX:
        return ca.vertcat(self.between, self.tilt)

    def look(self) -> list[Look]:
        return [Pin(self.frame_j, self.frame_i)]

    def units(self) -> list[str]:
        return ["m", "m", "m", "rad", "rad"]

    def turns(self) -> dict[str, Turn]:
        return {"angle": self.turn}
