"""Ball joint with play."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.elements.base import Look
from dalembert.elements.contact.clearance import ClearanceJoint
from dalembert.elements.look import Socket as BallJoint
from dalembert.elements.spatial.contact.shapes import Socket, Sphere


@dataclass(eq=False)
class ClearanceSpherical(ClearanceJoint):
    """A ball in a socket with play, free while ``g = clearance − |r_j − r_i| > 0``."""

    hole, inside = Socket, Sphere

    def look(self) -> list[Look]:
        return [BallJoint(self.point_j, self.point_i)]
