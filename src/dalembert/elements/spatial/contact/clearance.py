"""Spherical joint with clearance."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.elements.base import Look
from dalembert.elements.contact.clearance import ClearanceJoint
from dalembert.elements.look import Socket as BallJoint
from dalembert.elements.spatial.contact.shapes import Socket, Sphere


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
