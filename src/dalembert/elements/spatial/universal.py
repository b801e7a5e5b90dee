"""Universal (Cardan, Hooke) joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Look
from dalembert.elements.look import Cross
from dalembert.elements.pair import initial_value
from dalembert.elements.spatial.frame_pair import Turn
from dalembert.elements.spatial.joint import FrameJoint, TreeJoint
from dalembert.symbolic import rotation

CROSS = (0.0, 0.5**0.5, 0.0, 0.5**0.5)
"""Euler parameters of the rotation by π that exchanges x and z."""
PARALLEL = 1e-6
"""Threshold of the sine of the angle between axes below which they are parallel."""


@dataclass(eq=False)
class Universal(FrameJoint, TreeJoint):
    """Two shafts on a massless cross, whose arms are the z axes of the frames.

    ``Φ = [r_j − r_i; z_iᵀ z_j] = 0``. ``angle_i`` is the rotation of the cross on the first shaft
    about z_i, ``angle_j`` that of the second shaft on the cross about z_j, measured from the x axes
    if specified, otherwise from the initial poses.

    Raises
    ------
    ModelError
        The arms are parallel at the initial poses.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system, c, s = da.System("cardan shaft"), math.cos(0.5), math.sin(0.5)
    >>> a, b = system.add(spatial.Body("a")), system.add(spatial.Body("b"))
    >>> cross = spatial.Universal("cross", a.frame(axis=(0, 1, 0)), b.frame(axis=(c, 0, -s)))
    >>> first = system.add(spatial.Revolute("A", system.ground.frame(), a.frame()))
    >>> ends = system.ground.frame(axis=(s, 0, c)), b.frame(axis=(s, 0, c))
    >>> second, joint = system.add(spatial.Cylindrical("B", *ends)), system.add(cross)
    >>> drive = system.add(spatial.RotationalDriver("drive", first, da.t))
    >>> motion = da.solve_kinematics(system.build(), "pi/2", step="pi/2")
    >>> motion["B.angle_rate"].values / c  # from cos β to 1/cos β
    array([1.        , 1.29844641])
    """

    def look(self) -> list[Look]:
        return [Cross(self.frame_j, self.frame_i)]

    def residual(self) -> ca.SX:
        return ca.vertcat(self.between, ca.dot(self.frame_i.axis, self.frame_j.axis))

    def units(self) -> list[str]:
        return ["m", "m", "m", "rad"]

    def turns(self) -> dict[str, Turn]:
        rows = zip(("angle_i", "angle_j"), self._turns, self._have_x_axes, strict=True)
        return {name: turn if has_x else self.from_initial(turn) for name, turn, has_x in rows}

    @property
    def _turns(self) -> tuple[Turn, Turn]:
        """Rotations of cross on first shaft and of second shaft on cross, from the x axes."""
        axis_j = ca.mtimes(self.frame_i.axes.T, self.frame_j.axis)
        axis_i = ca.mtimes(self.frame_j.axes.T, self.frame_i.axis)
        return Turn(axis_j[0], axis_j[1]), Turn(axis_i[0], -axis_i[1])

    @property
    def _have_x_axes(self) -> tuple[bool, bool]:
        return self.frame_i.has_x_axis, self.frame_j.has_x_axis

    def conditions(self) -> list[Condition]:
        squared_sine = ca.sumsqr(ca.cross(self.frame_i.axis, self.frame_j.axis))
        start = initial_value(squared_sine, self.ends()).sx - PARALLEL**2
        message = "the arms of its cross are parallel; give frames whose z axes are perpendicular"
        all_specified = all(all(body.specified()) for body in self.ends() if body.name != "ground")
        return [*super().conditions(), *([(start, message)] if all_specified else [])]

    # joint coordinates ------------------------------------------------------------------------
    def turned(self, q: ca.SX) -> ca.SX:
        starts = zip(self._turns, self._have_x_axes, strict=True)
        first, second = (
            rotation.about_z(q[k] + (0 if has_x else self.at_initial(turn).angle))
            for k, (turn, has_x) in enumerate(starts)
        )
        return rotation.product(rotation.product(first, ca.SX(list(CROSS))), second)

    def subspace(self, q: ca.SX, axes_i: ca.SX, axes_j: ca.SX) -> ca.SX:
        return ca.vertcat(ca.SX(3, 2), ca.horzcat(axes_i[:, 2], axes_j[:, 2]))

    def opened(self, q: ca.SX, axes_i: ca.SX, axes_j: ca.SX) -> ca.SX:
        return ca.diagcat(ca.SX.eye(3), ca.cross(axes_j[:, 2], axes_i[:, 2]))
