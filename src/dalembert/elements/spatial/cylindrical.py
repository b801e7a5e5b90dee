"""Cylindrical joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.look import Collar
from dalembert.elements.spatial.axial_joint import AxialJoint
from dalembert.elements.spatial.frame_pair import Turn


@dataclass(eq=False)
class Cylindrical(AxialJoint):
    """Sleeve on a shaft: the z axes coincide; it slides and rotates.

    ``Φ = [x_iᵀ d; y_iᵀ d; x_iᵀ z_j; y_iᵀ z_j] = 0`` with ``d = r_j − r_i``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("sleeve", gravity=(0, 0, -9.81))
    >>> spin = dict(angular_velocity=(0, 0, 3), velocity=(0, 0, 9.81))
    >>> sleeve = system.add(spatial.Body("sleeve", mass=1.0, inertia=(0.1, 0.1, 0.05), **spin))
    >>> shaft = system.add(spatial.Cylindrical("shaft", system.ground.frame(), sleeve.frame()))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.01)
    >>> [round(motion[f"shaft.{free}"][-1].item(), 6) for free in ("displacement", "angle")]
    [4.905, 3.0]
    """

    slides = {"displacement": 2}

    def look(self) -> list[Look]:
        return [self.rail, Collar(self.frame_j, self.frame_i)]

    def residual(self) -> ca.SX:
        return ca.vertcat(self.travel[:2], self.tilt)

    def units(self) -> list[str]:
        return ["m", "m", "rad", "rad"]

    def turns(self) -> dict[str, Turn]:
        return {"angle": self.turn}
