"""Points on a line, a plane or a curve of another body."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look, Scalar, option, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.curves import Curve, OnCurve
from dalembert.elements.look import Rail, SlotPin
from dalembert.elements.point import Point
from dalembert.elements.spatial.joint import FramePointJoint


@dataclass(eq=False)
class PointOnLine(FramePointJoint):
    """Point of body j on the z axis of a frame, ``Φ = [x_iᵀ d; y_iᵀ d] = 0``, ``d = r_jP − r_i``.

    Parameters
    ----------
    frame_i : frame whose z axis is the line
    point_j : the point

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("ring", gravity=(0, 0, -10))
    >>> ring = system.add(spatial.Particle("ring", mass=0.3))
    >>> bar = system.ground.frame(axis=(0.6, 0, -0.8))
    >>> wire = system.add(spatial.PointOnLine("wire", bar, ring.center))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> motion["ring.acceleration"][0].values.round(6)  # 0.8 g along the line
    array([ 4.8,  0. , -6.4])
    """

    slides = {"displacement": 2}

    def residual(self) -> ca.SX:
        return self.travel[:2]

    def look(self) -> list[Look]:
        line = self.frame_i.local_axes[:, 2]
        return [Rail(self.frame_i, line, self.travel[2]), SlotPin(self.point_j, self.frame_i)]


@dataclass(eq=False)
class PointOnPlane(FramePointJoint):
    """Point of body j in the x-y plane of a frame, ``Φ = z_iᵀ d = 0``, ``d = r_jP − r_i``.

    Parameters
    ----------
    frame_i : frame whose x and y axes span the plane
    point_j : the point

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("ramp", gravity=(0, 0, -10))
    >>> drop = system.add(spatial.Particle("drop", mass=0.3))
    >>> ramp = system.ground.frame(axis=(0.6, 0, 0.8))
    >>> glide = system.add(spatial.PointOnPlane("glide", ramp, drop.center))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> round(motion["glide.force_norm"][0].item(), 6)  # 0.8 m g
    2.4
    """

    slides = {"displacement_x": 0, "displacement_y": 1}

    def residual(self) -> ca.SX:
        return self.travel[2]


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
    >>> helix = da.FormulaCurve(da.cos(da.curves.u), da.sin(da.curves.u), z=0.2 * da.curves.u)
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
