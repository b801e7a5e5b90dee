"""Massless links between two bodies: composite joints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.base import Condition, Look, Rate, Scalar, quantity
from dalembert.elements.look import Rod
from dalembert.elements.pair import ConstantDistance
from dalembert.elements.spatial.joint import FrameJoint, FramePointJoint

PARALLEL = 1e-6
"""Threshold of the sine of the angle between axes below which they are parallel."""


@dataclass(eq=False)
class RigidLink(ConstantDistance):
    """Link with a ball at each end (spherical–spherical), ``Φ = |r_jP − r_iP| − length``.

    The multiplier is the force in the link [N], positive in tension.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("lamp", gravity=(0, 0, -10))
    >>> lamp = system.add(spatial.Particle("lamp", mass=1.8, position=(0, 0, -0.8)))
    >>> left, right = system.ground.point(-0.6, 0, 0), system.ground.point(0.6, 0, 0)
    >>> a = system.add(spatial.RigidLink("a", left, lamp.center, length=1.0))
    >>> b = system.add(spatial.RigidLink("b", right, lamp.center, length=1.0))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["a.force_norm"].item(), 6)  # m g/2 over the cosine 0.8
    11.25
    """


class LinkMoments:
    """Mixin of massless links with moments at both ends.

    ``moment`` acts on body j at its end of the link, ``moment_i`` on body i at its hinge:
    ``M_i = −(M_j + d × F)`` with the force ``F`` on body j and ``d`` from the hinge to the end.
    """

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        link: Any = self
        force, moment = link.reaction()
        arm = link.place() - link.frame_i.position.sx
        measures: dict[str, tuple[ca.SX, str]] = super().measures(rate)  # type: ignore[misc]
        return measures | {"moment_i": (-(moment + ca.cross(arm, force)), "N m")}


@dataclass(eq=False)
class RevoluteSphericalLink(LinkMoments, FramePointJoint):
    """Link on a hinge of body i, with a ball at body j: ``Φ = [|d| − length; z_iᵀ d] = 0``.

    The link is normal to the axis of the hinge; its force [N] is the first multiplier. Measures are
    ``force``, the ``moment`` on body j at the ball, which is zero, and the ``moment_i`` on body i
    at the hinge.

    Parameters
    ----------
    frame_i : frame of the hinge, whose axis is z
    point_j : the ball
    length : from the hinge to the ball [m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("swing", gravity=(0, 0, -10))
    >>> seat = system.add(spatial.Particle("seat", mass=30.0, position=(0.1, 0, -2)))
    >>> hinge = system.ground.frame(axis=(0, 1, 0))
    >>> link = system.add(spatial.RevoluteSphericalLink("link", hinge, seat.center, length=2.0))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["link.force_norm"].item(), 6)  # m g
    300.0
    """

    length: Scalar = quantity("m", "from the hinge to the ball", above=0.0, keyword=True)

    def residual(self) -> ca.SX:
        return ca.vertcat(self.distance - self.length.sx, self.travel[2])

    def look(self) -> list[Look]:
        return [Rod(self.frame_i, self.end)]


@dataclass(eq=False)
class RevoluteRevoluteLink(LinkMoments, FrameJoint):
    """Link with a hinge at each end, along the common normal of both axes.

    Measures are ``force``, and the moments on the bodies at their ends, ``moment`` on body j and
    ``moment_i`` on body i.

    Parallel axes: ``Φ = [|d| − length; z_iᵀ d; x_iᵀ z_j; y_iᵀ z_j] = 0``. With a ``twist``:
    ``Φ = [|d| − length; z_iᵀ d; z_jᵀ d; angle of z_i and z_j − twist] = 0``.

    Parameters
    ----------
    length : from one axis to the other [m]
    twist : angle between the axes, above 0 and below π; parallel axes by default [rad]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("chain", gravity=(0, 0, -10))
    >>> load = system.add(spatial.Body("load", mass=2.0, inertia=(1, 1, 1), position=(0, 0, -1)))
    >>> across = dict(axis=(0, 1, 0))
    >>> hinges = system.ground.frame(**across), load.frame(**across)
    >>> link = system.add(spatial.RevoluteRevoluteLink("link", *hinges, length=1.0))
    >>> system.build().diagnosis.degrees_of_freedom  # a rotation at each end
    2
    """

    length: Scalar = quantity("m", "from one axis to the other", above=0.0, keyword=True)
    twist: Scalar = quantity("rad", "angle between the axes; parallel without", default=None)

    def residual(self) -> ca.SX:
        position = ca.vertcat(self.distance - self.length.sx, self.travel[2])
        if self.twist is None:
            return ca.vertcat(position, self.tilt)
        i, j = self.frame_i.axis, self.frame_j.axis
        sine = ca.sqrt(ca.sumsqr(ca.cross(i, j)))
        angle = ca.atan2(sine, ca.dot(i, j)) - self.twist.sx
        return ca.vertcat(position, ca.dot(j, self.between), angle)

    def assembly_conditions(self) -> ca.SX:
        return self.parallel if self.twist is None else super().assembly_conditions()

    def units(self) -> list[str]:
        return ["m", "m", *(["rad", "rad"] if self.twist is None else ["m", "rad"])]

    def look(self) -> list[Look]:
        return [Rod(self.frame_i, self.frame_j)]

    def conditions(self) -> list[Condition]:
        if self.twist is None:
            return super().conditions()
        twist = self.twist.sx
        message = (
            "its twist is {:g} rad, but it must be above 0 and below π; leave it out if the axes "
            "are parallel"
        )
        return [*super().conditions(), (ca.sin(twist) - PARALLEL, message, twist)]
