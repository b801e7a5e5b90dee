"""Joints as sequences of hinges, slides and balls."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch
from typing import Any

import casadi as ca

from dalembert.elements import planar, spatial
from dalembert.elements.base import Constraint
from dalembert.elements.point import Point
from dalembert.elements.spatial.axial_joint import AxialJoint

UP = ca.SX([0, 0, 1])
"""Axis of planar rotations."""


@dataclass(frozen=True, eq=False)
class FreeMotion:
    """A free motion of a joint, of its second body relative to the first.

    Attributes
    ----------
    kind : ``"hinge"``, ``"slide"`` or ``"ball"``
    name : of the coordinate
    axis : SX (3,) inertial axes; None for a ball
    """

    kind: str
    name: str
    axis: ca.SX | None


@dataclass(frozen=True, eq=False)
class Sequence:
    """Motions of a joint, from its first to its second body.

    Attributes
    ----------
    motions : each in the axes that the previous ones have moved
    anchor : the point of the second body, about which rotations are
    """

    motions: list[FreeMotion]
    anchor: Point


@singledispatch
def sequence_of(joint: Constraint) -> Sequence | None:
    """Motions of a joint; None if it is not composed of hinges, slides and balls."""
    return None


def _padded(vector: ca.SX) -> ca.SX:
    return vector if vector.numel() == 3 else ca.vertcat(vector, 0)


@sequence_of.register
def _(joint: planar.Revolute) -> Sequence:
    return Sequence([FreeMotion("hinge", f"{joint.name}.angle", UP)], joint.point_j)


@sequence_of.register
def _(joint: planar.Weld) -> Sequence:
    return Sequence([], joint.point_j)


@sequence_of.register(planar.Prismatic)
@sequence_of.register(planar.PinInSlot)
def _(joint: Any) -> Sequence:
    motions = [FreeMotion("slide", f"{joint.name}.displacement", _padded(joint.direction))]
    if isinstance(joint, planar.PinInSlot):
        motions.append(FreeMotion("hinge", f"{joint.name}.angle", UP))
    return Sequence(motions, joint.point_j)


def _slides(joint: Any) -> list[FreeMotion]:
    axes = joint.frame_i.axes
    return [
        FreeMotion("slide", f"{joint.name}.{name}", axes[:, k]) for name, k in joint.slides.items()
    ]


def relation_of(joint: Constraint) -> ca.SX | None:
    """Equation between the motions of a joint in addition to its sequence, such as a pitch."""
    return joint.equations[-1] if isinstance(joint, spatial.Screw) else None


@sequence_of.register
def _(joint: AxialJoint) -> Sequence:
    turns = [FreeMotion("hinge", f"{joint.name}.{n}", joint.frame_i.axis) for n in joint.turns()]
    return Sequence([*_slides(joint), *turns], joint.frame_j)


@sequence_of.register
def _(joint: spatial.Universal) -> Sequence:
    axes = zip(("angle_i", "angle_j"), (joint.frame_i.axis, joint.frame_j.axis), strict=True)
    return Sequence(
        [FreeMotion("hinge", f"{joint.name}.{name}", axis) for name, axis in axes], joint.frame_j
    )


@sequence_of.register
def _(joint: spatial.Spherical) -> Sequence:
    return Sequence([FreeMotion("ball", joint.name, None)], joint.point_j)


@sequence_of.register(spatial.PointOnLine)
@sequence_of.register(spatial.PointOnPlane)
def _(joint: Any) -> Sequence:
    return Sequence([*_slides(joint), FreeMotion("ball", joint.name, None)], joint.point_j)


CLOSED_BY_POINTS = (
    planar.Revolute,
    planar.Weld,
    spatial.Spherical,
    spatial.Revolute,
    spatial.Weld,
)
"""Joints whose equations are coincident points or frames, without a sliding part."""
