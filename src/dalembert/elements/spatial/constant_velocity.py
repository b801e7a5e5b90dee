"""Constant-velocity joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.look import Socket
from dalembert.elements.spatial.frame_pair import Turn
from dalembert.elements.spatial.joint import FrameJoint


@dataclass(eq=False)
class ConstantVelocity(FrameJoint):
    """Two shafts along the z axes of the frames, at any angle below π, with equal angular velocity.

    ``Φ = [r_j − r_i; twist] = 0``: the second frame is the first one rotated about an axis normal
    to its z axis, ``tan twist = (y_iᵀ x_j − x_iᵀ y_j) / (x_iᵀ x_j + y_iᵀ y_j)``. The last
    multiplier is the torque of the shafts [N m]. The twist is measured from the x axes if both were
    specified, otherwise from the initial poses.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("drive shaft")
    >>> tilt = dict(axis=(0.6, 0, 0.8))
    >>> a, b = system.add(spatial.Body("a")), system.add(spatial.Body("b"))
    >>> first = system.add(spatial.Revolute("O", system.ground.frame(), a.frame()))
    >>> ends = system.ground.frame(**tilt), b.frame(**tilt)
    >>> second = system.add(spatial.Cylindrical("P", *ends))
    >>> joint = system.add(spatial.ConstantVelocity("joint", a.frame(), b.frame(**tilt)))
    >>> drive = system.add(spatial.RotationalDriver("drive", first, 5 * da.t))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=0.5)
    >>> motion["P.angle_rate"].values.round(6)  # equal at all angles
    array([5., 5., 5.])
    """

    @property
    def twist(self) -> Turn:
        """Angle of one shaft relative to the other."""
        cosines = ca.mtimes(self.frame_i.axes[:, :2].T, self.frame_j.axes[:, :2])
        twist = Turn(cosines[0, 0] + cosines[1, 1], cosines[1, 0] - cosines[0, 1])
        return twist if self.has_x_axes else self.from_initial(twist)

    def residual(self) -> ca.SX:
        return ca.vertcat(self.between, self.twist.angle)

    def units(self) -> list[str]:
        return ["m", "m", "m", "rad"]

    def look(self) -> list[Look]:
        return [Socket(self.frame_j, self.frame_i)]
