"""Rigid connection of two frames."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.look import Clamp
from dalembert.elements.spatial.axial_joint import FixedTurn


@dataclass(eq=False)
class Weld(FixedTurn):
    """Two frames coincide, ``Φ = [r_j − r_i; x_iᵀ z_j; y_iᵀ z_j; sin(turn − angle)] = 0``.

    The turn is the angle of the x axes about z if both frames specify one, otherwise the rotation
    from the initial poses.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("sign", gravity=(0, 0, -10))
    >>> arm = system.add(spatial.Bar("arm", length=2.0, radius=0.05, mass=3.0))
    >>> wall = system.add(spatial.Weld("wall", system.ground.frame(), arm.frame((-1, 0, 0))))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["wall.moment.y"].item(), 6)  # -m g l/2
    -30.0
    """

    def look(self) -> list[Look]:
        return [Clamp(self.frame_j, self.frame_i)]

    def residual(self) -> ca.SX:
        return ca.vertcat(self.between, self.orientation)

    def units(self) -> list[str]:
        return ["m", "m", "m", "rad", "rad", "rad"]
