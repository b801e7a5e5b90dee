"""Joints that prescribe the relative orientation of their frames."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.spatial.axial_joint import AxialJoint
from dalembert.elements.spatial.turn import Turn
from dalembert.errors import ModelError


@dataclass(eq=False)
class FixedTurn(AxialJoint):
    """A joint that lets its frames not turn against each other.

    The z axes are parallel. About them, the x axes enclose ``angle`` where both frames have x axes
    of their own; where one has only a z axis, the turn at the initial poses stays (of a body
    without ``rotation``, that at rest).

    Parameters
    ----------
    angle : turn of the second x axis from the first about z; both must be given [rad]
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
    def left(self) -> Turn:
        """The turn less the one that it should be."""
        return self.turn if self.angle is None else self.turn.after(Turn.of(self.angle.sx))

    @property
    def orientation(self) -> ca.SX:
        """``Φ`` (3,) of the axes."""
        return ca.vertcat(self.tilt, self.left.sine)

    def facing(self) -> ca.SX:
        return ca.vertcat(self.parallel, self.left.cosine)

    @property
    def fixed_turn(self) -> ca.SX:
        return ca.SX(0) if self.angle is None else self.angle.sx
