"""Prismatic joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.look import Slider
from dalembert.elements.spatial.axial_joint import FixedTurn


@dataclass(eq=False)
class Prismatic(FixedTurn):
    """Slider: the second origin on the first z axis, no relative rotation.

    ``Φ = [x_iᵀ d; y_iᵀ d; x_iᵀ z_j; y_iᵀ z_j; sin(turn − angle)] = 0`` with ``d = r_j − r_i``. The
    turn is the angle of the x axes about z if both frames specify one, otherwise the rotation from
    the initial poses.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("lift", gravity=(0, 0, -10))
    >>> cabin = system.add(spatial.Body("cabin", mass=500.0, inertia=(1, 1, 1)))
    >>> shaft = system.add(spatial.Prismatic("shaft", system.ground.frame(), cabin.frame()))
    >>> winch = system.add(spatial.JointActuator("winch", shaft, 5500.0))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> round(motion["shaft.displacement"][-1].item(), 6)  # (F/m - g) t²/2
    2.0
    """

    slides = {"displacement": 2}

    def look(self) -> list[Look]:
        return [self.rail, Slider(self.frame_j, self.frame_i)]

    def residual(self) -> ca.SX:
        return ca.vertcat(self.travel[:2], self.orientation)

    def units(self) -> list[str]:
        return ["m", "m", "rad", "rad", "rad"]
