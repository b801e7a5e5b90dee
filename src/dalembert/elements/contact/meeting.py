"""A place where two shapes meet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca

from dalembert.elements.base import Constraint
from dalembert.symbolic.rotation import across

VelocityAt = Callable[[ca.SX], ca.SX]
"""(3,) velocity of a body at an inertial place (3,)."""


@dataclass(frozen=True, eq=False)
class Meeting:
    """A place where two bodies may touch.

    Attributes
    ----------
    distance : positive while apart [m]
    normal : unit vector from the first body to the second, inertial components
    place : halfway between the two surfaces
    foot : equations that tell where it is, if it wanders over a curve
    """

    distance: ca.SX
    normal: ca.SX
    place: ca.SX
    foot: Constraint | None = None

    def reversed(self) -> Meeting:
        """The same with the bodies in the other order."""
        return replace(self, normal=-self.normal)

    @property
    def directions(self) -> ca.SX:
        """(n, n) the normal, and the directions along the surface."""
        n = self.normal
        return ca.horzcat(n, ca.vertcat(n[1], -n[0]) if n.numel() == 2 else across(n))

    def speeds(self, at_i: VelocityAt, at_j: VelocityAt) -> ca.SX:
        """(n,) velocity of the second body against the first, along the directions."""
        n = self.normal.numel()
        here = ca.vertcat(self.place, ca.SX.zeros(3 - n))
        return ca.mtimes(self.directions.T, (at_j(here) - at_i(here))[:n])

    def slip(self, body_i: Any, body_j: Any) -> ca.SX:
        """(1,) or (2,) velocity of the second body along the surface of the first."""
        return self.speeds(body_i.velocity_at, body_j.velocity_at)[1:]
