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
from dalembert.elements.joint_forces import free_motion
from dalembert.elements.look import Mark, Rail
from dalembert.elements.pair import Pair
from dalembert.elements.point import Point
from dalembert.elements.spatial.frame_pair import BetweenFrames, FrameAndPoint, OnFrame
from dalembert.elements.spatial.turn import Turn


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
