"""Knife-edge constraint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Constraint, Look
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.frame import Frame
from dalembert.elements.look import Mark
from dalembert.elements.pair import Pair, refuse_same_body
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
