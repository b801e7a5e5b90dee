"""Joints with a fixed relative orientation."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.spatial.axial_joint import AxialJoint
from dalembert.elements.spatial.turn import Turn
from dalembert.errors import ModelError


@dataclass(eq=False)
class FixedTurn(AxialJoint):
    """A joint without relative rotation of its frames.

    The z axes are parallel. If both frames specify x axes, these enclose ``angle``; otherwise the
    angle at the initial poses is kept (that of the identity for a body without ``rotation``).

    Parameters
    ----------
    angle : angle of the second x axis from the first about z; needs both x axes [rad]
    """

    angle: Scalar = quantity("rad", "turn of the second x axis from the first", default=None)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.angle is not None and not self.complete:
            raise ModelError(
                "angle= is counted from x axes, and a frame here has only a z axis; give both "
                "frames x=, axes= or rotation=",
                self.name,
            )

    @property
    def turn_deviation(self) -> Turn:
        """Rotation relative to the prescribed one."""
        return self.turn if self.angle is None else self.turn.after(Turn.of(self.angle.sx))

    @property
    def orientation(self) -> ca.SX:
        """Equations ``Φ`` (3,) of the orientation."""
        return ca.vertcat(self.tilt, self.turn_deviation.sine)

    def facing(self) -> ca.SX:
        return ca.vertcat(self.parallel, self.turn_deviation.cosine)

    @property
    def fixed_turn(self) -> ca.SX:
        return ca.SX(0) if self.angle is None else self.angle.sx
