"""Planar point on a curve: cam and follower, guided point."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look, Scalar, option, quantity
from dalembert.elements.curves import Curve, OnCurve
from dalembert.elements.look import Disc
from dalembert.elements.planar.body import Body
from dalembert.elements.planar.joint import InPlane
from dalembert.elements.point import Point


@dataclass(eq=False)
class PointOnCurve(InPlane, OnCurve):
    """Point of body j on a curve of body i.

    ``Φ = A_iᵀ (r_jP − r_i) − c(u) − radius · n(u) = 0`` with the curve parameter ``u`` as an
    additional massless coordinate, so that the contact transmits no force along the curve.

    Parameters
    ----------
    body_i : body that carries the curve
    point_j : the following point (centre of the roller)
    curve : Curve in the frame of body i
    radius : of a roller on the right of the curve (outside, if it runs anticlockwise) [m]
    parameter : initial guess of ``u``; the nearest point by default

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("bowl", gravity=(0, -9.81))
    >>> bead = system.add(planar.Particle("bead", mass=0.1, position=(0.3, 0.1)))
    >>> bowl = da.FormulaCurve(da.curves.u, da.curves.u**2)
    >>> wire = system.add(planar.PointOnCurve("wire", system.ground, bead.center, bowl))
    >>> rest = da.solve_equilibrium(system.build())
    >>> bool(abs(rest["bead.position"]).max() < 1e-6)  # at the bottom
    True
    """

    body_i: Body
    point_j: Point
    curve: Curve = option("the curve", default=None)
    radius: Scalar = quantity("m", "roller radius", default=0.0, minimum=0.0)
    parameter: Scalar = quantity(
        "1 | m | rad", "initial guess of the curve parameter", default=None
    )

    def target(self) -> ca.SX:
        return self.curve.offset_position(self.contact, self.radius.sx)

    def look(self) -> list[Look]:
        path, mark = super().look()
        wheel = [] if self.radius.sx.is_zero() else [Disc(self.point_j, self.radius.sx)]
        return [path, *wheel, mark]
