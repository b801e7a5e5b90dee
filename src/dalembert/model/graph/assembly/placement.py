"""Guesses of all coordinates, with missing poses placed through joints."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, TypeVar

import casadi as ca

from dalembert.elements.coordinates import Coordinates
from dalembert.elements.frame import Frame
from dalembert.elements.planar.body import PlanarFrame, rotation as plane_rotation
from dalembert.elements.planar.joint import TreeJoint
from dalembert.elements.point import Point
from dalembert.elements.spatial import Spherical
from dalembert.elements.spatial.axial_joint import AxialJoint, FixedTurn
from dalembert.elements.spatial.frame import SpatialFrame
from dalembert.elements.spatial.joint import FrameJoint
from dalembert.model.graph.assembly.guesses import Guesses
from dalembert.model.graph.description import Description
from dalembert.symbolic import rotation

Pose = TypeVar("Pose")
PlanarPose = tuple[ca.SX, ca.SX]
"""Position (2,) and angle of a body."""
UNROTATED = ca.SX(list(rotation.IDENTITY))


@dataclass(frozen=True)
class SpatialPose:
    """Origin and Euler parameters of a body."""

    origin: ca.SX
    euler: ca.SX

    def at(self, local: ca.SX) -> ca.SX:
        """Inertial position of a point of the body frame."""
        return self.origin + ca.mtimes(rotation.matrix(self.euler), local)


def placed_guesses(d: Description) -> ca.SX:
    """(n,) guesses of all coordinates, as formulas of parameters.

    Coordinates without a guess or a placed carrier are at rest at the origin.
    """
    placed = planar_poses(d) | spatial_poses(d)
    return ca.vertcat(*(placed[g.name] if g.name in placed else _guess(g) for g in d.coordinates))


def curve_searches(
    d: Description, guesses: Guesses
) -> list[tuple[int, list[int], tuple[float, float]]]:
    """Curve parameters without a guess: coordinate, equations, range."""
    owners, searches = d.rows, []
    for constraint in d.constraints:
        for part in constraint.own_coordinates():
            if part.guesses()[0][0] is None:
                index = guesses.pose_owners.index(part.name)
                rows = [k for k, (c, _) in enumerate(owners) if c is constraint]
                searches.append((index, rows, part.interval))
    return searches


def loosely_facing(d: Description) -> list[ca.SX]:
    """Orientations of joints that the guessed poses do not determine."""
    return [
        constraint.assembly_conditions()
        for constraint in d.constraints
        if not all(all(p.specified()) for p in constraint.parts() if p.name != "ground")
    ]


def _guess(group: Coordinates) -> ca.SX:
    guesses, rest = group.guesses()[0], group.rest
    values = (ca.SX(r) if g is None else g for g, r in zip(guesses, rest, strict=True))
    return ca.vertcat(*values)


def _carried_along(
    joints: Iterable[Any],
    placed: dict[str, Pose],
    loose: dict[str, Pose],
    carry: Callable[[Any, Any, Pose], Pose | None],
) -> dict[str, Pose]:
    """Name → pose of all bodies connected to placed ones, in breadth-first order.

    Parameters
    ----------
    joints : joints that may determine the pose of a body from that of the other one
    placed : known poses
    loose : poses of bodies to use if they are not connected to placed ones
    carry : joint, body and pose of the other body → its pose; None if it does not follow
    """
    of_body: dict[str, list[Any]] = defaultdict(list)
    for joint in joints:
        for body in joint.ends():
            of_body[body.owner.name].append(joint)
    poses = dict(placed)
    for root in (*placed, *loose):
        if root not in poses:
            poses[root] = loose[root]
        waiting = deque([root])
        while waiting:
            base = waiting.popleft()
            for joint in of_body[base]:
                child = joint.ends()[joint.ends()[0].owner.name == base].owner
                if child.name in poses:
                    continue
                pose = carry(joint, child, poses[base])
                if pose is not None:
                    poses[child.name] = pose
                    waiting.append(child.name)
    return poses


# planar bodies ----------------------------------------------------------------------------------
def planar_poses(d: Description) -> dict[str, ca.SX]:
    """Name → pose of the planar bodies with a guess, and of those connected to them.

    A body of known angle without a position is placed where its joint to a placed body closes; an
    angle is also known if the joint prescribes it.
    """
    bodies = [body for body in d.bodies if isinstance(body, PlanarFrame)]
    angles = {body.name: angle for body in bodies if (angle := _guessed_angle(body)) is not None}
    guessed: dict[str, PlanarPose] = {"ground": (ca.SX.zeros(2), ca.SX(0))}
    for body in bodies:
        if body.name in angles and body.initial[0] is not None:
            guessed[body.name] = body.initial[0].sx, angles[body.name]
    joints = (
        joint
        for joint in d.constraints
        if isinstance(joint, TreeJoint) and not joint.joint_coordinates()
    )
    placed = _carried_along(
        joints,
        guessed,
        {name: (ca.SX.zeros(2), angle) for name, angle in angles.items()},
        lambda joint, child, base: _carried_planar(joint, child, base, angles.get(child.name)),
    )
    return {
        body.name: _planar_pose(body, placed[body.name]) for body in bodies if body.name in placed
    }


def _planar_pose(body: PlanarFrame, placed: PlanarPose) -> ca.SX:
    """Pose of an undeformed body."""
    count = body.pose.numel()
    rigid = ca.vertcat(*placed)[: min(count, 3)]
    return ca.vertcat(rigid, ca.SX.zeros(count - rigid.numel()))


def _carried_planar(
    joint: TreeJoint, child: PlanarFrame, base: PlanarPose, angle: ca.SX | None
) -> PlanarPose | None:
    """Pose of a body at which its joint closes; None if its angle is unknown."""
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
    position = base[0] + ca.mtimes(plane_rotation(base[1]), on_base.undeformed)
    position += opening if forward else -opening
    return position - ca.mtimes(plane_rotation(angle), on_child.undeformed), angle


def _guessed_angle(body: PlanarFrame) -> ca.SX | None:
    """Guess of the angle; None if missing."""
    if not body.rotates:
        return ca.SX(0)
    guess = body.initial[1]
    return None if guess is None else guess.sx


# spatial bodies ---------------------------------------------------------------------------------
def spatial_poses(d: Description) -> dict[str, ca.SX]:
    """Name → pose of the spatial bodies with a guess, and of those connected to them.

    A body of known orientation is placed where the origins of its joint to a placed body coincide;
    ``Weld`` and ``Prismatic`` also determine orientations, and so does a joint along one axis whose
    rotation is counted from x axes, at zero.
    """
    bodies = [body for body in d.bodies if isinstance(body, SpatialFrame)]
    eulers = {b.name: e for b in bodies if (e := _guessed_orientation(b)) is not None}
    guessed = {"ground": SpatialPose(ca.SX.zeros(3), UNROTATED)}
    for body in bodies:
        if body.name in eulers and body.initial[0] is not None:
            guessed[body.name] = SpatialPose(body.initial[0].sx, eulers[body.name])
    placed = _carried_along(
        (joint for joint in d.constraints if isinstance(joint, (FrameJoint, Spherical))),
        guessed,
        {name: SpatialPose(ca.SX.zeros(3), euler) for name, euler in eulers.items()},
        lambda joint, child, base: _carried_spatial(joint, child, base, eulers.get(child.name)),
    )
    return {
        body.name: _spatial_pose(body, placed[body.name]) for body in bodies if body.name in placed
    }


def _guessed_orientation(body: SpatialFrame) -> ca.SX | None:
    """Guess of the Euler parameters; None if missing."""
    if not body.rotates:
        return UNROTATED
    guess = body.initial[1]
    return None if guess is None else guess.sx


def _carried_spatial(
    joint: Any, child: Any, base: SpatialPose, euler: ca.SX | None
) -> SpatialPose | None:
    """Pose of a body at which its joint closes; None if its orientation is unknown."""
    if not isinstance(child, SpatialFrame):
        return None
    kind = "frame" if isinstance(joint, FrameJoint) else "point"
    forward = joint.ends()[1].owner is child
    on_base, on_child = (getattr(joint, f"{kind}_{side}") for side in ("ij" if forward else "ji"))
    if euler is None and isinstance(joint, AxialJoint) and _has_zero(joint):
        euler = _prescribed(joint, base.euler, on_base, on_child, forward)
    if euler is None:
        return None
    if child.initial[0] is not None:
        return SpatialPose(child.initial[0].sx, euler)
    arm = ca.mtimes(rotation.matrix(euler), on_child.undeformed)
    return SpatialPose(base.at(on_base.undeformed) - arm, euler)


def _has_zero(joint: AxialJoint) -> bool:
    """Whether a joint determines the relative orientation of its frames at zero rotation."""
    return isinstance(joint, FixedTurn) or joint.has_x_axes


def _prescribed(
    joint: AxialJoint, base: ca.SX, on_base: Point, on_child: Point, forward: bool
) -> ca.SX:
    """Euler parameters of a body from the relative orientation prescribed by its joint."""
    assert isinstance(on_base, Frame) and isinstance(on_child, Frame)
    half = (joint.reference_angle + joint.fixed_turn) / (2 if forward else -2)
    turn = ca.vertcat(ca.cos(half), 0, 0, ca.sin(half))
    first, second = (rotation.from_matrix(frame.local_axes) for frame in (on_base, on_child))
    frame = rotation.product(rotation.product(base, first), turn)
    return rotation.product(frame, rotation.conjugate(second))


def _spatial_pose(body: SpatialFrame, placed: SpatialPose) -> ca.SX:
    """Mass centre, or origin, and Euler parameters of an undeformed body."""
    center = placed.at(body.offset)
    if not body.rotates:
        return center
    return ca.vertcat(center, placed.euler, ca.SX.zeros(body.pose.numel() - 7))
