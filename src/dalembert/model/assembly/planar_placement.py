"""Missing poses of bodies in the plane, placed through joints from those that are given."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.planar.body import PlanarFrame, rotation
from dalembert.elements.planar.joint import TreeJoint
from dalembert.model.assembly.joint_walk import carried_along
from dalembert.model.description import Description

Pose = tuple[ca.SX, ca.SX]
"""Position (2,) and angle of a body."""


def planar_poses(d: Description) -> dict[str, ca.SX]:
    """Name → pose, of the bodies in the plane that are given or hang on what is.

    A body of known angle without a position goes where its joint to a placed body closes, from
    joint to joint; an angle is known, too, where the joint prescribes it.
    """
    bodies = [body for body in d.bodies if isinstance(body, PlanarFrame)]
    angles = {body.name: angle for body in bodies if (angle := _given_angle(body)) is not None}
    given: dict[str, Pose] = {"ground": (ca.SX.zeros(2), ca.SX(0))}
    for body in bodies:
        if body.name in angles and body.initial[0] is not None:
            given[body.name] = body.initial[0].sx, angles[body.name]
    joints = (
        joint
        for joint in d.constraints
        if isinstance(joint, TreeJoint) and not joint.joint_coordinates()
    )
    placed = carried_along(
        joints,
        given,
        {name: (ca.SX.zeros(2), angle) for name, angle in angles.items()},
        lambda joint, child, base: _carried(joint, child, base, angles.get(child.name)),
    )
    return {body.name: _whole(body, placed[body.name]) for body in bodies if body.name in placed}


def _whole(body: PlanarFrame, placed: Pose) -> ca.SX:
    """The pose with nothing deformed."""
    count = body.pose.numel()
    rigid = ca.vertcat(*placed)[: min(count, 3)]
    return ca.vertcat(rigid, ca.SX.zeros(count - rigid.numel()))


def _carried(joint: TreeJoint, child: PlanarFrame, base: Pose, angle: ca.SX | None) -> Pose | None:
    """The pose of a body at which its joint closes, None where the angle is not known."""
    forward = joint.ends()[1].owner is child
    closed = ca.SX.zeros(joint.equations.numel())
    turn = joint.fixed_turn(closed)
    if angle is None and turn is not None:
        angle = base[1] + turn if forward else base[1] - turn
    if angle is None:
        return None
    if child.initial[0] is not None:
        return child.initial[0].sx, angle
    on_base, on_child = (joint.point_i, joint.point_j)[:: 1 if forward else -1]
    opening = joint.opening(ca.SX(0, 1), closed, base[1] if forward else angle)
    place = base[0] + ca.mtimes(rotation(base[1]), on_base.undeformed)
    place += opening if forward else -opening
    return place - ca.mtimes(rotation(angle), on_child.undeformed), angle


def _given_angle(body: PlanarFrame) -> ca.SX | None:
    """Its angle; None where it is missing."""
    if not body.rotates:
        return ca.SX(0)
    given = body.initial[1]
    return None if given is None else given.sx
