"""Missing poses placed through joints, from those that are given."""

from __future__ import annotations

from collections import defaultdict, deque

import casadi as ca

from dalembert.elements.planar.body import PlanarFrame, rotation
from dalembert.elements.planar.joint import TreeJoint
from dalembert.model.description import Description
from dalembert.model.spatial_placement import spatial_poses

Pose = tuple[ca.SX, ca.SX]
"""Position (2,) and angle of a body."""


def placed_guesses(d: Description) -> ca.SX:
    """(n,) guesses of all coordinates, as formulas of parameters.

    A body of known angle without a position goes where its joint to a placed body closes, from
    joint to joint; an angle is known, too, where the joint prescribes it. What cannot be placed so
    stays at zero.
    """
    joints: dict[str, list[TreeJoint]] = defaultdict(list)
    for joint in d.constraints:
        if isinstance(joint, TreeJoint) and not joint.joint_coordinates():
            for body in joint.ends():
                joints[body.name].append(joint)
    planar = [body for body in d.bodies if isinstance(body, PlanarFrame)]
    angles = {body.name: angle for body in planar if (angle := _given_angle(body)) is not None}
    placed: dict[str, Pose] = {"ground": (ca.SX.zeros(2), ca.SX(0))}
    for body in planar:
        if body.name in angles and body.initial[0] is not None:
            placed[body.name] = body.initial[0].sx, angles[body.name]
    for root in (*placed, *angles):
        placed.setdefault(root, (ca.SX.zeros(2), angles.get(root, ca.SX(0))))
        waiting = deque([root])  # all that hangs on it; what hangs on nothing is at the origin
        while waiting:
            base = waiting.popleft()
            for joint in joints[base]:
                child = joint.ends()[joint.ends()[0].name == base].owner
                if child.name not in placed:
                    found = _carried(joint, child, placed[base], angles.get(child.name))
                    if found is not None:
                        placed[child.name] = found
                        waiting.append(child.name)
    in_space = spatial_poses(d)
    return ca.vertcat(
        *(
            in_space[group.name] if group.name in in_space else _pose(group, placed)
            for group in d.coordinates
        )
    )


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


def _pose(group, placed: dict[str, Pose]) -> ca.SX:
    if group.name in placed:
        count = group.pose.numel()
        rigid = ca.vertcat(*placed[group.name])[: min(count, 3)]
        return ca.vertcat(rigid, ca.SX.zeros(count - rigid.numel()))  # nothing is deformed
    given, rest = group.guesses()[0], group.rest
    known = (ca.SX(r) if g is None else g for g, r in zip(given, rest, strict=True))
    return ca.vertcat(*known)


def _given_angle(body: PlanarFrame) -> ca.SX | None:
    """Its angle; None where it is missing."""
    if not body.rotates:
        return ca.SX(0)
    given = body.initial[1]
    return None if given is None else given.sx
