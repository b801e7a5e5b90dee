"""Massless rigid link with a pin at each end."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.planar.joint import PointJoint


@dataclass(eq=False)
class RigidLink(PointJoint):
    """Constant distance between two points (revolute–revolute), ``Φ = |r_jP − r_iP| − length``.

    The multiplier is the force in the link [N], positive in tension.

    Parameters
    ----------
    length : distance of the points [m]
    """

    length: Scalar = quantity("m", "distance of the two points", above=0.0, keyword=True)
    kind = "rigid_link"

    def residual(self) -> ca.SX:
        d = self.between
        return ca.sqrt(ca.sumsqr(d)) - self.length.sx
