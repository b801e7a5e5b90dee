"""Spherical joint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.coordinates import JointSpace
from dalembert.elements.frame import Frame
from dalembert.elements.look import Socket
from dalembert.elements.pair import PointJoint
from dalembert.elements.point import Point
from dalembert.elements.spatial.frame import Attitude
from dalembert.elements.spatial.joint import TreeJoint
from dalembert.symbolic import rotation


@dataclass(eq=False)
class Spherical(PointJoint, TreeJoint):
    """Ball and socket: two points coincide, ``Φ = r_jP − r_iP = 0``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("pendulum", gravity=(0, 0, -9.81))
    >>> bob = system.add(spatial.Sphere("bob", radius=0.1, mass=2.0, position=(0.2, 0, -1)))
    >>> socket = system.ground.point(0, 0, 0)
    >>> ball = system.add(spatial.Spherical("ball", socket, bob.point(0, 0, 1)))
    >>> model = system.build()
    >>> model.diagnosis.degrees_of_freedom
    3
    >>> rest = da.solve_equilibrium(model)
    >>> round(rest["ball.force.z"].item(), 6)  # the weight
    19.62
    """

    def look(self) -> list[Look]:
        return [Socket(self.point_j, self.point_i)]

    def residual(self) -> ca.SX:
        return self.between

    # joint coordinates ------------------------------------------------------------------------
    def end_frames(self) -> tuple[Point, Point]:
        return self.point_i, self.point_j

    def joint_space(self) -> JointSpace:
        """Euler parameters of the second body relative to the first, with the relative ``ω'``.

        Those of the second frame relative to the first, if the ends are frames.
        """
        ends = self.end_frames()
        first, second = (
            e.orientation if isinstance(e, Frame) else e.body.orientation for e in ends
        )
        reading = rotation.product(rotation.conjugate(first), second)
        return JointSpace.of(Attitude(self.name), reading)

    def turned(self, q: ca.SX) -> ca.SX:
        return q

    def subspace(self, q: ca.SX, axes_i: ca.SX, axes_j: ca.SX) -> ca.SX:
        return ca.vertcat(ca.SX(3, 3), axes_j)

    def opened(self, q: ca.SX, axes_i: ca.SX, axes_j: ca.SX) -> ca.SX:
        return ca.vertcat(ca.SX.eye(3), ca.SX(3, 3))
