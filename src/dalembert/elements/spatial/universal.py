"""Universal (Cardan, Hooke) joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Look
from dalembert.elements.look import Cross
from dalembert.elements.pair import initial_value
from dalembert.elements.spatial.joint import FrameJoint
from dalembert.elements.spatial.turn import Turn

PARALLEL = 1e-6
"""Sine of the angle between axes that are taken for parallel."""


@dataclass(eq=False)
class Universal(FrameJoint):
    """Two shafts on a massless cross, whose arms are the z axes of the frames.

    ``Φ = [r_j − r_i; z_iᵀ z_j] = 0``. ``angle_i`` is the turn of the cross on the first shaft about
    z_i, ``angle_j`` that of the second shaft on the cross about z_j, counted from the x axes or,
    where one was not given, from the initial poses.

    Raises
    ------
    ModelError
        The arms are parallel at the initial poses.
    """

    def look(self) -> list[Look]:
        return [Cross(self.frame_j, self.frame_i)]

    def residual(self) -> ca.SX:
        return ca.vertcat(self.between, ca.dot(self.frame_i.axis, self.frame_j.axis))

    def units(self) -> list[str]:
        return ["m", "m", "m", "rad"]

    def turns(self) -> dict[str, Turn]:
        i, j = self.frame_i, self.frame_j
        across, along = ca.mtimes(i.axes.T, j.axis), ca.mtimes(j.axes.T, i.axis)
        on_first, on_second = Turn(across[0], across[1]), Turn(along[0], -along[1])
        return {
            "angle_i": on_first if i.complete else self.since_start(on_first),
            "angle_j": on_second if j.complete else self.since_start(on_second),
        }

    def conditions(self) -> list[Condition]:
        across = ca.sumsqr(ca.cross(self.frame_i.axis, self.frame_j.axis))
        start = initial_value(across, self.ends()).sx - PARALLEL**2
        told = "the arms of its cross are parallel; give frames whose z axes are perpendicular"
        given = all(all(body.guessed()) for body in self.ends() if body.name != "ground")
        return [*super().conditions(), *([(start, told)] if given else [])]
