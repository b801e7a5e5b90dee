"""Spatial balls, sockets and half-spaces, and the spherical joint with clearance."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Look, option
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.contact import ClearanceJoint
from dalembert.elements.contact.shapes import Ball, Flat, Hollow, Round
from dalembert.elements.frame import Frame
from dalembert.elements.look import Socket as BallJoint
from dalembert.elements.spatial.contact.polyhedron import Polyhedron
from dalembert.elements.spatial.contact.solids import Corners
from dalembert.elements.spatial.look import Floor, Orb
from dalembert.errors import ModelError


@dataclass(eq=False)
class Sphere(Round):
    """Ball.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> contact = spatial.contact
    >>> system = da.System("billiards")
    >>> a = system.add(spatial.Sphere("a", radius=0.03, mass=0.2, velocity=(2, 0, 0)))
    >>> b = system.add(spatial.Sphere("b", radius=0.03, mass=0.2, position=(0.2, 0, 0)))
    >>> balls = [contact.Sphere(ball.center, 0.03) for ball in (a, b)]
    >>> touch = system.add(spatial.Contact("touch", *balls, law=contact.Restitution(1.0)))
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=0.01)
    >>> round(motion["b.vx"][-1].item(), 6)  # the whole speed is transferred
    2.0
    """

    space = 3
    feels = (Ball, Corners, Polyhedron)

    def look(self, near: ca.SX) -> list[Look]:
        return [Orb(self.point, self.radius.sx)]


@dataclass(eq=False)
class Socket(Hollow):
    """Spherical socket, touched from inside.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> contact = spatial.contact
    >>> system = da.System("ball in a bowl", gravity=(0, 0, -10))
    >>> ball = system.add(spatial.Sphere("ball", radius=0.1, mass=4.0, position=(0, 0, -0.4001)))
    >>> bowl = contact.Socket(system.ground.point(0, 0, 0), 0.5)
    >>> rim, law = contact.Sphere(ball.center, 0.1), contact.KelvinVoigt(stiffness=1e5)
    >>> touch = system.add(spatial.Contact("touch", bowl, rim, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["ball.z"].item(), 6)  # difference of the radii plus m g/k
    -0.4004
    """

    space = 3

    def look(self, near: ca.SX) -> list[Look]:
        return [Orb(self.point, self.radius.sx)]


@dataclass(eq=False)
class HalfSpace(Flat):
    """Material below the x-y plane of a frame.

    Parameters
    ----------
    point : frame of a body; its z axis is the outward normal

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> contact = spatial.contact
    >>> system = da.System("ramp", gravity=(0, 0, -10))
    >>> stone = system.add(spatial.Particle("stone", mass=1.0))
    >>> ramp = contact.HalfSpace(system.ground.frame(axis=(-0.6, 0, 0.8)))
    >>> law, tip = contact.Restitution(), contact.Vertex(stone.center)
    >>> touch = system.add(spatial.Contact("touch", ramp, tip, law=law))
    >>> motion = da.solve_dynamics(system.build(), 0.5, step=0.05)
    >>> motion["stone.velocity"][-1].values.round(6)  # 0.6 g t down the ramp
    array([-2.4,  0. , -1.8])
    """

    space = 3
    point: Frame = option("frame whose z axis is the outward normal")

    def __post_init__(self) -> None:
        if isinstance(self.point, BodyElement):
            self.point = Frame(self.point)
        if not isinstance(self.point, Frame):
            raise ModelError(
                f"needs a frame of a body, e.g. ground.frame(axis=(0, 0, 1)); got {self.point!r}",
                "HalfSpace",
            )
        super().__post_init__()

    @property
    def outward(self) -> ca.SX:
        return self.point.axis

    @property
    def along(self) -> list[ca.SX]:
        return ca.horzsplit(self.point.local_axes[:, :2])

    def conditions(self) -> list[Condition]:
        return [*super().conditions(), *self.point.conditions()]

    def look(self, near: ca.SX) -> list[Look]:
        relative = near - ca.repmat(self.point.position.sx, 1, near.shape[1])
        along = ca.horzcat(*(self.carrier.turned(tangent) for tangent in self.along))
        return [Floor(self.point, ca.mtimes(along.T, relative))]


@dataclass(eq=False)
class ClearanceSpherical(ClearanceJoint):
    """A ball in a socket with clearance, free while ``g = clearance − |r_j − r_i| > 0``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("ball joint", gravity=(0, 0, -10))
    >>> ball = system.add(spatial.Particle("ball", mass=4.0, position=(0, 0, -0.00101)))
    >>> socket, law = system.ground.point(0, 0, 0), spatial.contact.KelvinVoigt(stiffness=1e7)
    >>> joint = system.add(spatial.ClearanceSpherical("joint", socket, ball.center,
    ...     radius=0.02, clearance=0.001, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["ball.z"].item() * 1e6, 3)  # clearance plus m g/k [µm]
    -1004.0
    """

    hole, inside = Socket, Sphere

    def look(self) -> list[Look]:
        return [BallJoint(self.point_j, self.point_i)]
