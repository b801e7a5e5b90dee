"""Joints with parallel z axes, which slide along axes of the first frame and rotate about z."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.spatial.frame_pair import Turn
from dalembert.elements.spatial.joint import FrameJoint, TreeJoint
from dalembert.errors import ModelError
from dalembert.symbolic import rotation


@dataclass(eq=False)
class AxialJoint(FrameJoint, TreeJoint):
    """Frames with parallel z axes; ``slides`` and ``turns`` list the free motions.

    The origins coincide if no displacement is free. Otherwise the equations of displacements are
    along the other axes of the first frame. Those of the tilt follow, and that of a fixed rotation.
    """

    def assembly_conditions(self) -> ca.SX:
        return self.parallel

    @property
    def fixed_turn(self) -> ca.SX:
        """Rotation about z if it is not free."""
        return ca.SX(0)

    def placed(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        """(3,) displacement in the axes of the first frame, and rotation about z."""
        displacement = ca.SX(3, 1)
        for k, axis in enumerate(self.slides.values()):
            displacement[axis] = q[k]
        return displacement, q[len(self.slides)] if self.turns() else self.fixed_turn

    def turned(self, q: ca.SX) -> ca.SX:
        return rotation.about_z(self.reference_angle + self.placed(q)[1])

    def offset(self, q: ca.SX, axes_i: ca.SX) -> ca.SX:
        return ca.mtimes(axes_i, self.placed(q)[0])

    def subspace(self, q: ca.SX, axes_i: ca.SX, axes_j: ca.SX) -> ca.SX:
        displacement, turn = (ca.jacobian(part, q) for part in self.placed(q))
        return ca.vertcat(ca.mtimes(axes_i, displacement), ca.mtimes(axes_i[:, 2], turn))

    def opened(self, q: ca.SX, axes_i: ca.SX, axes_j: ca.SX) -> ca.SX:
        fixed = [k for k in range(3) if k not in self.slides.values()]
        directions = axes_i[:, fixed] if self.slides else ca.SX.eye(3)
        tilts = [ca.cross(axes_j[:, 2], axes_i[:, k]) for k in range(2)]
        return ca.diagcat(directions, ca.horzcat(*tilts, *self._spins(axes_i, axes_j)))

    def _spins(self, axes_i: ca.SX, axes_j: ca.SX) -> list[ca.SX]:
        """Motion that opens the sine of a fixed rotation, which may be off by half a turn."""
        if self.turns():
            return []
        turn = self.reference_angle + self.fixed_turn
        direction = axes_i[:, 0] * ca.cos(turn) + axes_i[:, 1] * ca.sin(turn)
        return [axes_i[:, 2] * ca.dot(axes_j[:, 0], direction)]


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
        if self.angle is not None and not self.has_x_axes:
            raise ModelError(
                "angle= is counted from x axes, and a frame here has only a z axis; give both "
                "frames x=, axes= or rotation=",
                self.name,
            )

    @property
    def turn_deviation(self) -> Turn:
        """Rotation relative to the prescribed one."""
        return self.turn if self.angle is None else self.turn.relative_to(Turn.of(self.angle.sx))

    @property
    def orientation(self) -> ca.SX:
        """Equations ``Φ`` (3,) of the orientation."""
        return ca.vertcat(self.tilt, self.turn_deviation.sine)

    def assembly_conditions(self) -> ca.SX:
        return ca.vertcat(self.parallel, self.turn_deviation.cosine)

    @property
    def fixed_turn(self) -> ca.SX:
        return ca.SX(0) if self.angle is None else self.angle.sx
