"""Joints with parallel z axes, which slide along axes of the first frame and rotate about z."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.spatial.joint import FrameJoint
from dalembert.elements.spatial.tree_joint import TreeJoint
from dalembert.symbolic import rotation


@dataclass(eq=False)
class AxialJoint(FrameJoint, TreeJoint):
    """Frames with parallel z axes; ``slides`` and ``turns`` list the free motions.

    The origins coincide if no displacement is free. Otherwise the equations of displacements are
    along the other axes of the first frame. Those of the tilt follow, and that of a fixed rotation.
    """

    def facing(self) -> ca.SX:
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
        return rotation.about_z(self.first_turn + self.placed(q)[1])

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
        turn = self.first_turn + self.fixed_turn
        direction = axes_i[:, 0] * ca.cos(turn) + axes_i[:, 1] * ca.sin(turn)
        return [axes_i[:, 2] * ca.dot(axes_j[:, 0], direction)]
