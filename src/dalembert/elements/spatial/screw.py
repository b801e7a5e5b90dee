"""Screw joint."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Look, Scalar, quantity
from dalembert.elements.coordinates import JointSpace
from dalembert.elements.look import Nut
from dalembert.elements.pair import initial_value
from dalembert.elements.spatial.cylindrical import Cylindrical
from dalembert.elements.spatial.frame_pair import Turn

SMALLEST_PITCH = 1e-12
"""Lower limit of the pitch [m]."""


@dataclass(eq=False)
class Screw(Cylindrical):
    """Nut on a spindle: a cylindrical joint whose displacement is proportional to its rotation.

    ``Φ = […; displacement − pitch · turn / 2π] = 0``, for any number of revolutions. The last
    multiplier is the axial force [N]. If both frames specify an x axis they coincide at zero
    displacement; otherwise rotation and displacement are measured from the initial poses.

    Parameters
    ----------
    pitch : displacement per revolution, negative for a left-hand thread [m]

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("jack")
    >>> nut = system.add(spatial.Body("nut"))
    >>> spindle = spatial.Screw("spindle", system.ground.frame(), nut.frame(), pitch=0.01)
    >>> joint = system.add(spindle)
    >>> drive = system.add(spatial.RotationalDriver("drive", joint, 8 * math.pi * da.t))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=1.0)
    >>> motion["nut.z"].values.round(6)  # four revolutions
    array([0.  , 0.04])
    """

    pitch: Scalar = quantity("m", "displacement per full turn", keyword=True)

    def look(self) -> list[Look]:
        return [self.rail, Nut(self.frame_j, self.frame_i)]

    def residual(self) -> ca.SX:
        deviation = Turn.of(self._turn_at(self.travel[2])).relative_to(self.turn)
        return ca.vertcat(super().residual(), self._lead * deviation.angle)

    @property
    def _lead(self) -> ca.SX:
        """Displacement per radian."""
        return self.pitch.sx / (2 * math.pi)

    def _turn_at(self, displacement: ca.SX) -> ca.SX:
        """The rotation at a displacement."""
        start = ca.SX(0) if self.has_x_axes else initial_value(self.travel[2], self.ends()).sx
        return (displacement - start) / self._lead

    def units(self) -> list[str]:
        return [*super().units(), "m"]

    def conditions(self) -> list[Condition]:
        pitch = self.pitch.sx
        message = "a screw needs a pitch, got {:g} m; without one use Revolute"
        return [*super().conditions(), (ca.fabs(pitch) - SMALLEST_PITCH, message, pitch)]

    # joint coordinates ------------------------------------------------------------------------
    def joint_space(self) -> JointSpace:
        """The displacement, which distinguishes full revolutions."""
        return JointSpace([f"{self.name}.displacement"], ["m"], self.travel[2])

    def placed(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        return ca.vertcat(ca.SX(2, 1), q), self._turn_at(q)

    def opened(self, q: ca.SX, axes_i: ca.SX, axes_j: ca.SX) -> ca.SX:
        axial = ca.vertcat(axes_i[:, 2], ca.SX(3, 1))
        return ca.horzcat(super().opened(q, axes_i, axes_j), axial)
