"""Nonholonomic constraints: knife edge and rolling disc."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Constraint, Look, Scalar, Vector, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.frame import Frame
from dalembert.elements.look import Contact, Disc, Mark
from dalembert.elements.pair import Pair, need_body, refuse_same_body
from dalembert.elements.rotation import unit
from dalembert.elements.spatial.frame_pair import need_frame


@dataclass(eq=False)
class KnifeEdge(Pair, Constraint):
    """The origin of a frame moves along its x axis only, ``Ψ = bᵀ (v_P − v_plane) = 0``.

    The direction ``b = n × x / |n × x|`` lies in the plane, normal to the edge. Another joint must
    keep the point in the plane. The multiplier is the force normal to the edge.

    Parameters
    ----------
    frame : on the body with the edge; the edge is its x axis
    plane : frame with the normal ``n`` as its z axis

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("sledge")
    >>> sledge = system.add(spatial.Body("sledge", mass=1.0, inertia=(1, 1, 1), velocity=(2, 0, 0)))
    >>> plane = system.add(spatial.Planar("ice", system.ground.frame(), sledge.frame()))
    >>> blade = system.add(spatial.KnifeEdge("blade", sledge.frame(), system.ground.frame()))
    >>> push = system.add(spatial.Force("push", sledge.center, (0, 5, 0)))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> motion["sledge.velocity"][-1].values.round(6)  # the blade carries the push
    array([2., 0., 0.])
    """

    frame: Frame
    plane: Frame

    def __post_init__(self) -> None:
        self.frame = need_frame(self.frame, self.name, "frame")
        self.plane = need_frame(self.plane, self.name, "plane")
        refuse_same_body(self.plane.body, self.frame.body, self.name)
        super().__post_init__()

    def ends(self) -> tuple[BodyElement, BodyElement]:
        return self.plane.body, self.frame.body

    def parts(self) -> list[Coordinates]:
        return list(self.ends())

    def look(self) -> list[Look]:
        return [Mark(self.frame, self.plane)]

    def place(self) -> ca.SX:
        return self.frame.position.sx

    def residual(self) -> ca.SX:
        return ca.SX(0, 1)

    def slipping(self) -> ca.SX:
        place, normal = self.place(), ca.cross(self.plane.axis, self.frame.axes[:, 0])
        slip = self.frame.body.velocity_at(place) - self.plane.body.velocity_at(place)
        return ca.dot(normal, slip) / ca.sqrt(ca.sumsqr(normal))


@dataclass(eq=False)
class RollingDisc(Pair, Constraint):
    """A thin disc rolls on a plane without slip.

    With the plane's normal ``n``, the disc's axle ``a`` and its centre C, the lowest point of the
    rim is ``P = C + r d``, ``d = −(n − (n·a) a) / |n − (n·a) a|``, and

        Φ = nᵀ (r_P − r_plane) = 0,      Ψ = [x y]ᵀ (v_P,disc − v_P,plane) = 0.

    The first multiplier is the normal force of the contact, the others are friction forces.

    Parameters
    ----------
    body : the disc
    plane : frame whose x and y axes span the plane; of the ground or another body
    radius : [m]
    axis : (3,) axle in the body frame
    center : (3,) centre of the disc in the body frame [m]; the origin by default

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("coin")
    >>> coin = system.add(spatial.Body("coin", mass=1.0, inertia=(0.01, 0.02, 0.01),
    ...     position=(0, 0, 0.2), velocity=(3, 0, 0), angular_velocity=(0, 15, 0)))
    >>> floor = system.add(spatial.RollingDisc("floor", coin, system.ground.frame(), radius=0.2))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> motion["coin.position"][-1].values.round(6)  # straight, ω r t
    array([3. , 0. , 0.2])
    """

    body: BodyElement
    plane: Frame
    radius: Scalar = quantity("m", "radius", above=0.0, keyword=True)
    axis: Vector = quantity("", "axle in the body frame", default=(0.0, 1.0, 0.0), size=3)
    center: Vector = quantity("m", "centre in the body frame", default=(0.0, 0.0, 0.0), size=3)

    def __post_init__(self) -> None:
        self.body = need_body(self.body, self.name, "body")
        self.plane = need_frame(self.plane, self.name, "plane")
        refuse_same_body(self.plane.body, self.body, self.name)
        super().__post_init__()

    def ends(self) -> tuple[BodyElement, BodyElement]:
        return self.plane.body, self.body

    def parts(self) -> list[Coordinates]:
        return list(self.ends())

    def look(self) -> list[Look]:
        wheel = self.body.frame(self.center, axis=self.axis)
        return [Disc(wheel, self.radius.sx), Contact(self.place())]

    def place(self) -> ca.SX:
        """The contact point."""
        normal = self.plane.axis
        axle = self.body.turned(unit(self.axis.sx, f"{self.name}.axis"))
        up = normal - ca.dot(normal, axle) * axle
        return self.body.locate(self.center.sx) - self.radius.sx * up / ca.sqrt(ca.sumsqr(up))

    def residual(self) -> ca.SX:
        return ca.dot(self.plane.axis, self.place() - self.plane.position.sx)

    def slipping(self) -> ca.SX:
        place = self.place()
        slip = self.body.velocity_at(place) - self.plane.body.velocity_at(place)
        return ca.mtimes(self.plane.axes[:, :2].T, slip)

    def units(self) -> list[str]:
        return ["m", "m", "m"]
