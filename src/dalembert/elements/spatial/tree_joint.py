"""Spatial joints that can carry a body: explicit form of their free motion."""

from __future__ import annotations

from typing import Any

import casadi as ca

from dalembert.elements.coordinates import JointSpace
from dalembert.elements.frame import Frame
from dalembert.elements.point import Point
from dalembert.elements.spatial.body import Body
from dalembert.symbolic import rotation
from dalembert.symbolic.formulas.expression import stack


class TreeJoint:
    """A joint that can carry a body: its constraint equations are also known explicitly.

    With the joint coordinates q and their speeds u the motion of the second frame is

        R_j = R_i R(turned),      r_j = r_i + offset,
        ω_j = ω_i + S_ω u,        ṙ_j = ṙ_i + ω_i × offset + S_v u.

    Vectors are in inertial axes; a joint states them in terms of the axes ``axes_i`` and ``axes_j``
    (3, 3) of both frames. It also states the motions that open its equations, ``Φ = z`` (7.7).
    """

    name: str
    equations: ca.SX
    frame_i: Frame
    frame_j: Frame

    def ends(self) -> tuple[Any, Any]:
        """First and second body."""
        raise NotImplementedError

    def freedoms(self) -> dict[str, tuple[ca.SX, str]]:
        """Free relative motions: name → (coordinate, unit)."""
        raise NotImplementedError

    def sides(self) -> tuple[Point, Point]:
        """The frames or points that it connects; a point has the axes of its body."""
        return self.frame_i, self.frame_j

    def joint_space(self) -> JointSpace:
        """The joint coordinates; those of ``freedoms`` by default."""
        free = self.freedoms()
        names = [f"{self.name}.{name}" for name in free]
        return JointSpace(names, [u for _, u in free.values()], stack(s for s, _ in free.values()))

    def turned(self, q: ca.SX) -> ca.SX:
        """(4,) Euler parameters of the second frame in the first."""
        return ca.SX(list(rotation.IDENTITY))

    def offset(self, q: ca.SX, axes_i: ca.SX) -> ca.SX:
        """(3,) vector from the first to the second origin."""
        return ca.SX(3, 1)

    def subspace(self, q: ca.SX, axes_i: ca.SX, axes_j: ca.SX) -> ca.SX:
        """(6, k) motion subspace ``[S_v; S_ω]``."""
        raise NotImplementedError

    def opened(self, q: ca.SX, axes_i: ca.SX, axes_j: ca.SX) -> ca.SX:
        """(6, m) motions ``[E_v; E_ω]`` that open one equation each, ``Φ̇ = ż`` (7.9)."""
        raise NotImplementedError

    def carries(self, child: Any) -> bool:
        """Whether the freedoms of a body are those that the joint removes and leaves."""
        if not isinstance(child, Body):
            return False
        free = self.joint_space().twist.numel() if child.rotates else 0
        return child.twist.numel() == free + self.equations.numel()
