"""Revolute joint with clearance."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.elements.base import Look
from dalembert.elements.contact.clearance import ClearanceJoint
from dalembert.elements.look import Pin
from dalembert.elements.planar.contact.shapes import Bore, Circle
from dalembert.elements.planar.in_plane import InPlane


@dataclass(eq=False)
class ClearanceRevolute(InPlane, ClearanceJoint):
    """A journal in a bearing with clearance, free while ``g = clearance − |r_j − r_i| > 0``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("play", gravity=(0, -10))
    >>> shaft = system.add(planar.Particle("shaft", mass=4.0, position=(0, -0.00101)))
    >>> bearing = system.add(planar.ClearanceRevolute("bearing", system.ground.center, shaft.center,
    ...     radius=0.02, clearance=0.001, law=planar.contact.KelvinVoigt(stiffness=1e7)))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["shaft.y"].item() * 1e6, 3)  # clearance plus m g/k [µm]
    -1004.0
    """

    hole, inside = Bore, Circle

    def look(self) -> list[Look]:
        return [Pin(self.point_j, self.point_i)]
