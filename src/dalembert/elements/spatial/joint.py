"""Base classes of spatial joints.

Joints combine primitive constraints between the frames i and j, with ``d = r_j − r_i``: two
perpendicular directions (dot-1, ``aᵀ b = 0``, radians), a direction perpendicular to ``d``
(dot-2, ``aᵀ d = 0``, metres), coincident origins (``d = 0``) and their constant distance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca

from dalembert.elements.base import Constraint, Look
from dalembert.elements.coordinates import JointSpace
from dalembert.elements.frame import Frame
from dalembert.elements.joint_forces import free_motion
from dalembert.elements.look import Mark, Rail
from dalembert.elements.pair import Pair
from dalembert.elements.point import Point
from dalembert.elements.spatial.body import Body
from dalembert.elements.spatial.frame_pair import BetweenFrames, FrameAndPoint, OnFrame, Turn
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

    def end_frames(self) -> tuple[Point, Point]:
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
        """Whether constrained and free motions of the joint span the motions of a body."""
        if not isinstance(child, Body):
            return False
        free = self.joint_space().twist.numel() if child.rotates else 0
        return child.twist.numel() == free + self.equations.numel()


def turn_of(joint: Any, motion: str | None, owner: str) -> Turn:
    """A free rotation of a joint, the first one by default."""
    free = joint.turns() if isinstance(joint, SpatialJoint) else {}
    return free[free_motion(joint, free, motion, owner, "turn")]


def slide_of(joint: Any, motion: str | None, owner: str) -> int:
    """The axis of a free displacement of a joint, of the first one by default."""
    free = joint.slides if isinstance(joint, SpatialJoint) else {}
    return free[free_motion(joint, free, motion, owner, "displacement")]


@dataclass(eq=False)
class SpatialJoint(OnFrame, Pair, Constraint):
    """Constraint between a frame of one body and a point or frame of another."""

    slides: ClassVar[dict[str, int]] = {}
    """Free displacements: name → index of the axis of the first frame."""

    def look(self) -> list[Look]:
        return [Mark(self.end, self.frame_i)]

    @property
    def end_points(self) -> tuple[Point, Point]:
        return self.frame_i, self.end

    @property
    def rail(self) -> Rail:
        """The first z axis over the travel of the second origin."""
        return Rail(self.frame_i, self.frame_i.local_axes[:, 2], self.travel[2])

    def place(self) -> ca.SX:
        return self.end.position.sx

    def turns(self) -> dict[str, Turn]:
        """Free rotations by name."""
        return {}

    def freedoms(self) -> dict[str, tuple[ca.SX, str]]:
        travels = {name: (self.travel[axis], "m") for name, axis in self.slides.items()}
        return travels | {name: (turn.angle, "rad") for name, turn in self.turns().items()}


@dataclass(eq=False)
class FrameJoint(BetweenFrames, SpatialJoint):
    """Constraint between a frame of one body and a frame of another.

    Parameters
    ----------
    frame_i, frame_j : frames of the first and the second body
    """


@dataclass(eq=False)
class FramePointJoint(FrameAndPoint, SpatialJoint):
    """Constraint between a frame of one body and a point of another.

    Parameters
    ----------
    frame_i : frame of the first body
    point_j : point of the second body
    """
