"""Missing poses of bodies in space, placed through joints from those that are given."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.frame import Frame
from dalembert.elements.point import Point
from dalembert.elements.spatial import Spherical
from dalembert.elements.spatial.axial_joint import FixedTurn
from dalembert.elements.spatial.frame import SpatialFrame
from dalembert.elements.spatial.joint import FrameJoint
from dalembert.model.assembly.joint_walk import carried_along
from dalembert.model.description import Description
from dalembert.symbolic import rotation

UNTURNED = ca.SX(list(rotation.IDENTITY))


@dataclass(frozen=True)
class Placed:
    """Where the origin of a body is, and its Euler parameters."""

    origin: ca.SX
    euler: ca.SX

    def at(self, local: ca.SX) -> ca.SX:
        """Inertial position of a place in the body frame."""
        return self.origin + ca.mtimes(rotation.matrix(self.euler), local)


def spatial_poses(d: Description) -> dict[str, ca.SX]:
    """Name → pose, of the bodies in space that are given or hang on what is.

    A body of known orientation goes where the origins of its joint to a placed body coincide, from
    joint to joint; ``Weld`` and ``Prismatic`` tell orientations, too.
    """
    solids = [body for body in d.bodies if isinstance(body, SpatialFrame)]
    turned = {b.name: e for b in solids if (e := _given_orientation(b)) is not None}
    given = {"ground": Placed(ca.SX.zeros(3), UNTURNED)}
    for body in solids:
        if body.name in turned and body.initial[0] is not None:
            given[body.name] = Placed(body.initial[0].sx, turned[body.name])
    placed = carried_along(
        (joint for joint in d.constraints if isinstance(joint, (FrameJoint, Spherical))),
        given,
        {name: Placed(ca.SX.zeros(3), euler) for name, euler in turned.items()},
        lambda joint, child, base: _carried(joint, child, base, turned.get(child.name)),
    )
    return {body.name: _pose(body, placed[body.name]) for body in solids if body.name in placed}


def _given_orientation(body: SpatialFrame) -> ca.SX | None:
    """Its Euler parameters; None where they are missing."""
    if not body.rotates:
        return UNTURNED
    given = body.initial[1]
    return None if given is None else given.sx


def _carried(joint: Any, child: Any, base: Placed, euler: ca.SX | None) -> Placed | None:
    """The pose of a body at which its joint closes, None where its orientation is not known."""
    if not isinstance(child, SpatialFrame):
        return None
    held = "frame" if isinstance(joint, FrameJoint) else "point"
    forward = joint.ends()[1].owner is child
    on_base, on_child = (getattr(joint, f"{held}_{side}") for side in ("ij" if forward else "ji"))
    if euler is None and isinstance(joint, FixedTurn):
        euler = _prescribed(joint, base.euler, on_base, on_child, forward)
    if euler is None:
        return None
    if child.initial[0] is not None:
        return Placed(child.initial[0].sx, euler)
    arm = ca.mtimes(rotation.matrix(euler), on_child.undeformed)
    return Placed(base.at(on_base.undeformed) - arm, euler)


def _prescribed(
    joint: FixedTurn, base: ca.SX, on_base: Point, on_child: Point, forward: bool
) -> ca.SX:
    """Euler parameters at which the frames lie to each other as the joint asks for."""
    assert isinstance(on_base, Frame) and isinstance(on_child, Frame)
    half = (joint.reference_angle + joint.fixed_turn) / (2 if forward else -2)
    turn = ca.vertcat(ca.cos(half), 0, 0, ca.sin(half))
    first, second = (rotation.from_matrix(frame.local_axes) for frame in (on_base, on_child))
    there = rotation.product(rotation.product(base, first), turn)
    return rotation.product(there, rotation.conjugate(second))


def _pose(body: SpatialFrame, placed: Placed) -> ca.SX:
    """Mass centre, or origin, and Euler parameters; nothing deformed."""
    center = placed.at(body.offset)
    if not body.rotates:
        return center
    return ca.vertcat(center, placed.euler, ca.SX.zeros(body.pose.numel() - 7))
