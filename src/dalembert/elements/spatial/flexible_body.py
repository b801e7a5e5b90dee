"""Spatial flexible bodies."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Vector, option, quantity
from dalembert.elements.flexible.body import Flexible
from dalembert.elements.flexible.section import Section
from dalembert.elements.rotation import Orientation, as_orientation
from dalembert.elements.spatial.frame import SpatialFrame
from dalembert.symbolic import rotation


class SpatialSection(Section):
    """Interface rotated by the normalised ``(1, ψ/2)``, which equals a small rotation ``ψ``."""

    @property
    def mass_center(self) -> ca.SX:  # type: ignore[override]
        return self.place

    @property
    def _half(self) -> ca.SX:
        return self.turn / 2

    def locate(self, local: ca.SX) -> ca.SX:
        return self.place + self.turned(local)

    def turned(self, local: ca.SX) -> ca.SX:
        if not self.rotates:
            return self.owner.turned(local)
        half = self._half
        cross = ca.cross(half, local)
        rotated = local + 2 * (cross + ca.cross(half, cross)) / (1 + ca.sumsqr(half))
        return self.owner.turned(rotated)

    @property
    def orientation(self) -> ca.SX:
        if not self.rotates:
            return self.owner.orientation
        turn = ca.vertcat(1, self._half)
        return rotation.product(self.owner.orientation, turn / ca.sqrt(ca.sumsqr(turn)))

    @property
    def turning(self) -> ca.SX:
        if not self.rotates:
            return self.owner.turning
        half = self._half
        rate = ca.jtimes(half, self.owner.q, self.owner.twist[6:])
        relative = 2 * (rate + ca.cross(half, rate)) / (1 + ca.sumsqr(half))
        return self.owner.turning + self.owner.turned(relative)


@dataclass(eq=False)
class FlexibleBody(Flexible, SpatialFrame):
    """A spatial structure as a body, ``y = (r, e, q)``, ``v = (ṙ, ω', q̇)``.

    Parameters
    ----------
    position : (3,) initial position of the frame's origin: the interface, or the mass centre [m]
    rotation : initial orientation of the structure's axes
    velocity : (3,) initial velocity of the origin, inertial axes [m/s]
    angular_velocity : (3,) initial, inertial axes [rad/s]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial, structures
    >>> rod = da.Structure("rod")
    >>> a, b = rod.node("a", 0, 0, 0), rod.node("b", 1, 0, 0)
    >>> steel, profile = structures.Material(2e11, density=7850), structures.tube(0.02, 0.002)
    >>> numbers = steel.of(structures.SpaceFrame) | profile.of(structures.SpaceFrame)
    >>> element = rod.add(structures.SpaceFrame("e", a, b, **numbers))
    >>> system = da.System("free rod")
    >>> body = system.add(spatial.FlexibleBody("rod", rod.build(), {"left": "a", "right": "b"}))
    >>> system.build().diagnosis.degrees_of_freedom  # twelve of its nodes
    12
    """

    position: Vector = quantity("m", "initial position of the frame", default=None, size=3)
    rotation: Orientation = option("initial orientation", default=None)
    velocity: Vector = quantity("m/s", "initial velocity", default=None, size=3)
    angular_velocity: Vector = quantity(
        "rad/s", "initial angular velocity, inertial axes", default=None, size=3
    )

    section_kind = SpatialSection

    def __post_init__(self) -> None:
        if self.rotation is not None:
            self.rotation = as_orientation(self.rotation, f"{self.name}.rotation")
        super().__post_init__()

    def _make_pose(self) -> None:
        self._make_coordinates(self.modal_names)
        self.q = self.pose[7:]

    def _frame_measures(self) -> dict[str, tuple[ca.SX, str]]:
        return self.motion_measures()

    @property
    def frame_axes(self) -> ca.SX:
        return self.axes

    @property
    def local_spin(self) -> ca.SX:
        return self.spin

    def _turning_momentum(self, momentum: ca.SX) -> ca.SX:
        angular = ca.cross(self.spin, momentum[3:6])
        return ca.vertcat(ca.SX(3, 1), angular, ca.SX(self.shapes.count, 1))

    def specified(self) -> list[bool]:
        return [*super().specified(), *(True for _ in range(self.shapes.count))]
