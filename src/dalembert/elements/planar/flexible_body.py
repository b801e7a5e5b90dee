"""Planar flexible bodies."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, Vector, quantity
from dalembert.elements.coordinates import rate_of
from dalembert.elements.flexible.body import Flexible
from dalembert.elements.flexible.section import Section
from dalembert.elements.planar.body import MovingFrame, PlanarFrame, motion_measures, rotation
from dalembert.symbolic.formulas.expression import t


class PlanarSection(PlanarFrame, Section):
    """Interface of a planar flexible body; its angle is that of the frame plus a small rotation."""

    @property
    def pose_position(self) -> ca.SX:  # type: ignore[override]
        return self.place

    mass_center = pose_position  # type: ignore[assignment]

    @property
    def pose_angle(self) -> ca.SX:  # type: ignore[override]
        return self.owner.pose_angle + (self.turn if self.rotates else 0)

    @property
    def turning(self) -> ca.SX:
        return ca.vertcat(0, 0, rate_of(self.pose_angle, [self], t.sx))


@dataclass(eq=False)
class FlexibleBody(Flexible, MovingFrame):
    """A planar structure as a body, ``y = (x, y, φ, q)``.

    Parameters
    ----------
    position : (2,) initial position of the frame's origin: the interface, or the mass centre [m]
    angle : initial angle of the structure's axes [rad]
    velocity, angular_velocity : initial speeds [m/s], [rad/s]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar, structures
    >>> beam = da.Structure("arm")
    >>> a, b = beam.node("a", 0, 0), beam.node("b", 1, 0)
    >>> numbers = dict(area=1e-3, second_moment=1e-7, modulus=7e10, density=2700)
    >>> element = beam.add(structures.Frame("e", a, b, **numbers))
    >>> system = da.System("flexible pendulum", gravity=(0, -9.81))
    >>> arm = planar.FlexibleBody("arm", beam.build(), {"pin": "a", "tip": "b"}, reference="pin")
    >>> hinge = planar.Revolute("O", system.ground.center, system.add(arm).point("pin"))
    >>> joint = system.add(hinge)
    >>> system.build().diagnosis.degrees_of_freedom  # one rotation and three shapes
    4
    """

    position: Vector = quantity("m", "initial position of the frame", default=None, size=2)
    angle: Scalar = quantity("rad", "initial angle", default=None)
    velocity: Vector = quantity("m/s", "initial velocity", default=None, size=2)
    angular_velocity: Scalar = quantity("rad/s", "initial angular velocity", default=None)

    section_kind = PlanarSection

    def _make_pose(self) -> None:
        names = ("x", "y", "angle", *self.modal_names)
        self.make_symbols(names, ("m", "m", "rad", *("m" for _ in self.modal_names)))
        self.pose_position, self.pose_angle, self.q = self.pose[:2], self.pose[2], self.pose[3:]

    def _frame_measures(self) -> dict[str, tuple[ca.SX, str]]:
        return motion_measures(self)

    @property
    def frame_axes(self) -> ca.SX:
        return rotation(self.pose_angle)

    @property
    def local_spin(self) -> ca.SX:
        return self.twist[2]
