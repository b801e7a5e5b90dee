"""Torsion springs and bushings between frames."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import ForceElement, Look, Vector, quantity
from dalembert.elements.elastic_bearing import ElasticBearing
from dalembert.elements.look import Brake, Sleeve, Spiral
from dalembert.elements.spatial.frame_pair import BetweenFrames
from dalembert.elements.springs import AngularSpring


@dataclass(eq=False)
class FramePair(BetweenFrames, ForceElement):
    """Force element between two frames."""


@dataclass(eq=False)
class TorsionSpring(AngularSpring, FramePair):
    """Torsion spring and damper about the z axis of the first frame.

    Its coordinate is the angle of the second x axis about the first z axis, within half a turn
    either way of where the x axes coincide; unless both were given, of the initial poses. In a
    joint, give the frames of the joint.

    Parameters
    ----------
    frame_i, frame_j : frames of the first and the second body
    stiffness : [N m/rad]
    damping : [N m s/rad]
    free_angle : angle without moment [rad]
    law : function (extension, rate) → additional moment [N m]
    """

    def coordinate(self) -> ca.SX:
        return self.turn.angle

    def look(self) -> list[Look]:
        return self.drawn(Spiral, Brake, *self.ends())


@dataclass(eq=False)
class Bushing(ElasticBearing, FramePair):
    """Elastic bearing: stiffness and damping along and about the axes of the first frame.

    The second origin is displaced by ``d = R_iᵀ (r_j − r_i)``, the second frame turned by
    ``θ = 2 sin(φ/2) n``, φ about n, in the axes of the first: the rotation vector ``φ n`` to 1 %
    up to φ = 0.5 rad. ``½ Σ k s²`` is stored and ``Σ c ṡ²`` dissipated exactly, up to half a turn;
    so the moment of a turn about an axis is ``k sin φ``. The measures ``force`` and ``moment`` are
    ``k s + c ṡ``.

    Parameters
    ----------
    frame_i, frame_j : frames of the first and the second body
    stiffness : (3,) along the axes of frame i [N/m]
    damping : (3,) [N s/m]
    rotational_stiffness, rotational_damping : (3,) about them [N m/rad], [N m s/rad]
    """

    stiffness: Vector = quantity("N/m", "stiffness along the axes of frame i", size=3)
    damping: Vector = quantity("N s/m", "damping", default=(0.0,) * 3, size=3)
    rotational_stiffness: Vector = quantity(
        "N m/rad", "stiffness about the axes of frame i", default=(0.0,) * 3, size=3
    )
    rotational_damping: Vector = quantity(
        "N m s/rad", "damping about them", default=(0.0,) * 3, size=3
    )

    def deformation(self) -> ca.SX:
        r = ca.mtimes(self.frame_i.axes.T, self.frame_j.axes)
        doubled = ca.vertcat(r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1])
        return ca.vertcat(self.travel, doubled / ca.sqrt(1 + ca.trace(r)))

    def look(self) -> list[Look]:
        return [Sleeve(self.frame_i, self.frame_j)]
