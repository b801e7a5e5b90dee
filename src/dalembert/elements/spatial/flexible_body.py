"""Flexible body in space."""

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
    """It is turned by ``(1, ψ/2)`` at length one, which agrees with the small turn ``ψ``."""

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
        across = ca.cross(half, local)
        swung = local + 2 * (across + ca.cross(half, across)) / (1 + ca.sumsqr(half))
        return self.owner.turned(swung)

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
        own = 2 * (rate + ca.cross(half, rate)) / (1 + ca.sumsqr(half))
        return self.owner.turning + self.owner.turned(own)


@dataclass(eq=False)
class FlexibleBody(SpatialFrame, Flexible):
    """A structure in space as a body, ``y = (r, e, q)``, ``v = (ṙ, ω', q̇)``.

    Parameters
    ----------
    structure : StructuralModel, without supports
    interface : name → nodes that move as one rigid section, or nodes, each by itself
    modes : how many modes between the interfaces, at most
    up_to : only those up to this frequency [rad/s]
    reference : the interface in which the frame is fixed, or ``"mean"`` axes (default)
    stiffening : with displacements of second order, which make centrifugal stiffening; the frame is
        fixed in an interface
    damping_ratio : ``ζ`` of every shape with the frame at rest
    rayleigh : (2,) shares of mass [1/s] and stiffness [s] in the damping
    parameters : values of the structure's parameters
    position : (3,) initial position of the frame's origin: the interface, or the mass centre [m]
    rotation : initial orientation of the structure's axes
    velocity : (3,) initial velocity of the origin, inertial axes [m/s]
    angular_velocity : (3,) initial, inertial axes [rad/s]

    Raises
    ------
    ModelError
        A structure with supports or of another space, no interface, an unknown frame.
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
        self.initial = (self.position, self.rotation, self.velocity, self.angular_velocity)
        self._reduce()
        self._make_coordinates(self.modal_names)
        self.q = self.pose[7:]
        self.mass_center = self.locate(self._centre())
        self.declare(self.motion_measures() | self._modal_measures(), {})
        self._make_sections()

    @property
    def frame_axes(self) -> ca.SX:
        return self.axes

    @property
    def local_spin(self) -> ca.SX:
        return self.spin

    def _turning_momentum(self, momentum: ca.SX) -> ca.SX:
        turned = ca.cross(self.spin, momentum[3:6])
        return ca.vertcat(ca.SX(3, 1), turned, ca.SX(self.shapes.count, 1))

    def guesses(self) -> tuple[list, list]:
        still = [ca.SX(0)] * self.shapes.count
        pose, twist = super().guesses()
        return [*pose, *still], [*twist, *still]

    def guessed(self) -> list[bool]:
        return [*super().guessed(), *(True for _ in range(self.shapes.count))]
