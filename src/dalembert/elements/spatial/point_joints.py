"""Points on a line or a plane of another body."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.look import Rail, SlotPin
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
