"""Spatial point on a curve."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.elements.base import Scalar, option, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.curves import Curve
from dalembert.elements.point import Point
from dalembert.elements.point_on_curve import OnCurve


@dataclass(eq=False)
class PointOnCurve(OnCurve):
    """Point of body j on a curve of body i, ``Φ = A_iᵀ (r_jP − r_i) − c(u) = 0``.

    The curve parameter ``u`` is an additional massless coordinate, so that the contact transmits
    no force along the curve.

    Parameters
    ----------
    body_i : body that carries the curve
    point_j : the following point
    curve : Curve of three components in the frame of body i
    parameter : initial guess of ``u``; the nearest point by default

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("slide", gravity=(0, 0, -9.81))
    >>> helix = da.FormulaCurve(da.cos(da.u), da.sin(da.u), z=0.2 * da.u)
    >>> bead = system.add(spatial.Particle("bead", mass=0.1, position=(1, 0, 0)))
    >>> wire = system.add(spatial.PointOnCurve("wire", system.ground, bead.center, helix))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.01)
    >>> round(motion["bead.z"][-1].item() * 2 / 9.81, 6)  # 0.2²/(1 + 0.2²)
    -0.038462
    """

    body_i: BodyElement
    point_j: Point
    curve: Curve = option("the curve", default=None)
    parameter: Scalar = quantity(
        "1 | m | rad", "initial guess of the curve parameter", default=None
    )
