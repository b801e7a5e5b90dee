"""A place where two shapes meet."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca

from dalembert.elements.base import Constraint
from dalembert.symbolic.rotation import across


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

    def slip(self, body_i, body_j) -> ca.SX:
        """(1,) or (2,) velocity of the second body along the surface of the first."""
        n = self.normal.numel()
        here = ca.vertcat(self.place, ca.SX.zeros(3 - n))
        between = (body_j.velocity_at(here) - body_i.velocity_at(here))[:n]
        return ca.mtimes(tangents(self.normal).T, between)


def tangents(normal: ca.SX) -> ca.SX:
    """(n, n−1) directions along a surface."""
    if normal.numel() == 2:
        return ca.vertcat(normal[1], -normal[0])
    return across(normal)
