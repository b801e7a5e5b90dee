"""Flexible body in the plane."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, Vector, quantity
from dalembert.elements.coordinates import rate_of
from dalembert.elements.flexible.body import Flexible
from dalembert.elements.flexible.section import Section
from dalembert.elements.planar.body import PlanarFrame, motion_measures, rotation
from dalembert.symbolic.expression import t


class PlanarSection(PlanarFrame, Section):
    """Its angle is that of the frame and its small turn."""

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
class FlexibleBody(PlanarFrame, Flexible):
    """A structure of the plane as a body, ``y = (x, y, φ, q)``.

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
    position : (2,) initial position of the frame's origin: the interface, or the mass centre [m]
    angle : initial angle of the structure's axes [rad]
    velocity, angular_velocity : initial speeds [m/s], [rad/s]

    Raises
    ------
    ModelError
        A structure with supports or of another space, no interface, an unknown frame.
    """

    position: Vector = quantity("m", "initial position of the frame", default=None, size=2)
    angle: Scalar = quantity("rad", "initial angle", default=None)
    velocity: Vector = quantity("m/s", "initial velocity", default=None, size=2)
    angular_velocity: Scalar = quantity("rad/s", "initial angular velocity", default=None)

    initial_fields = ("position", "angle", "velocity", "angular_velocity")
    section_kind = PlanarSection

    def __post_init__(self) -> None:
        super().__post_init__()
        self.initial = (self.position, self.angle, self.velocity, self.angular_velocity)
        self._reduce()
        names = ("x", "y", "angle", *self.modal_names)
        self.make_symbols(names, ("m", "m", "rad", *("m" for _ in self.modal_names)))
        self.pose_position, self.pose_angle, self.q = self.pose[:2], self.pose[2], self.pose[3:]
        self.mass_center = self.locate(self._centre())
        self.declare(motion_measures(self) | self._modal_measures(), {})
        self._make_sections()

    @property
    def frame_axes(self) -> ca.SX:
        return rotation(self.pose_angle)

    @property
    def local_spin(self) -> ca.SX:
        return self.twist[2]

    @property
    def turning(self) -> ca.SX:
        return ca.vertcat(0, 0, self.twist[2])

    def wrench(self, effort: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        return effort[:2], effort[2], self.pose_position

    def guesses(self) -> tuple[list, list]:
        still = [ca.SX(0)] * self.shapes.count

        def entries(vector, scalar) -> list:
            first = [None, None] if vector is None else ca.vertsplit(vector.sx)
            return [*first, None if scalar is None else scalar.sx, *still]

        position, angle, velocity, angular_velocity = self.initial
        return entries(position, angle), entries(velocity, angular_velocity)
