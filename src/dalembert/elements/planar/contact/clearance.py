"""Pin joint with play."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.elements.base import Look
from dalembert.elements.contact.clearance import ClearanceJoint
from dalembert.elements.look import Pin
from dalembert.elements.planar.contact.shapes import Bore, Circle
from dalembert.elements.planar.in_plane import InPlane


@dataclass(eq=False)
class ClearanceRevolute(InPlane, ClearanceJoint):
    """A journal in a bearing with play, free while ``g = clearance − |r_j − r_i| > 0``."""

    hole, inside = Bore, Circle

    def look(self) -> list[Look]:
        return [Pin(self.point_j, self.point_i)]
