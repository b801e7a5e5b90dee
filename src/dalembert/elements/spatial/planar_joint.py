"""Planar joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.look import Table
from dalembert.elements.spatial.axial_joint import AxialJoint
from dalembert.elements.spatial.frame_pair import Turn


@dataclass(eq=False)
class Planar(AxialJoint):
    """The x-y planes of both frames coincide; they slide and rotate relative to each other.

    ``Φ = [z_iᵀ d; x_iᵀ z_j; y_iᵀ z_j] = 0`` with ``d = r_j − r_i``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("puck")
    >>> puck = system.add(spatial.Cylinder("puck", radius=0.04, length=0.02, mass=0.2))
    >>> ice = system.add(spatial.Planar("ice", system.ground.frame(), puck.frame()))
    >>> model = system.build()
    >>> model.diagnosis.degrees_of_freedom, list(ice.freedoms())
    (3, ['displacement_x', 'displacement_y', 'angle'])
    """

    slides = {"displacement_x": 0, "displacement_y": 1}

    def look(self) -> list[Look]:
        return [Table(self.frame_j, self.frame_i)]

    def residual(self) -> ca.SX:
        return ca.vertcat(self.travel[2], self.tilt)

    def units(self) -> list[str]:
        return ["m", "rad", "rad"]

    def turns(self) -> dict[str, Turn]:
        return {"angle": self.turn}
