"""Spatial bodies carried by joints: poses, speeds and motion subspaces.

Twists in the recursion are the velocity of the mass centre and the angular velocity, both in
inertial axes. With ``D`` from the mass centre of the carrier to that of the child, ``b`` to it
from the point of the joint on its second body, and + if the child is the second body, else −,

    ω = ω_carrier ± S_ω u,      ṙ = ṙ_carrier + ω_carrier × D ± (S_v u + S_ω u × b).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from dalembert.elements.coordinates import JointSpace
from dalembert.elements.frame import Frame
from dalembert.elements.point import Point
from dalembert.elements.spatial.body import Body
from dalembert.elements.spatial.joint import TreeJoint
from dalembert.model.graph.tree.link import AT_REST, Link, RigidMotion, Step
from dalembert.symbolic import rotation


@dataclass(frozen=True, eq=False)
class Placement:
    """Placement of a body relative to its carrier, in inertial axes.

    Attributes
    ----------
    euler, axes : SX (4,), (3, 3), orientation of the child
    frames : SX (3, 3), axes of the first and of the second frame of the joint
    lever, offset, arm : SX (3,) from mass centre to joint on the carrier, along the joint, and
        from joint to mass centre on the child
    """

    euler: ca.SX
    axes: ca.SX
    frames: list[ca.SX]
    lever: ca.SX
    offset: ca.SX
    arm: ca.SX


@dataclass(frozen=True, eq=False)
class SpatialLink(Link):
    """A spatial body with its joint.

    Attributes
    ----------
    carrier, joint : at most one end of the joint is the ground
    branch : Euler parameters of the constant rotation of the second frame in addition to q
    """

    group: Body
    carrier: Body
    joint: TreeJoint
    branch: tuple[float, ...] = rotation.IDENTITY

    @property
    def branch_offset(self) -> ca.SX:
        if not self.group.rotates:
            return super().branch_offset
        first, second = (
            rotation.product(body.orientation, _euler(point))
            for body, point in zip(self.joint.ends(), self.joint.end_frames(), strict=True)
        )
        by_q = rotation.product(first, self.joint.turned(self.space.reading))
        return rotation.product(rotation.conjugate(by_q), second)

    def on_branch(self, offset: np.ndarray) -> SpatialLink:
        nearest = int(np.argmax(np.abs(offset)))
        branch = [math.copysign(1.0, x) if k == nearest else 0.0 for k, x in enumerate(offset)]
        return replace(self, branch=tuple(branch))

    def step(self, carrier: Step | None) -> Step:
        base = AT_REST if carrier is None or carrier.rigid is None else carrier.rigid
        place, u = self._placement(base), self.space.twist
        apart = place.lever + place.offset + place.arm
        subspace = self._of_child(self._motion_subspace(place.frames), place)
        own = ca.mtimes(subspace, u)
        relative = ca.cross(base.spin, apart) + own[:3]
        velocity, spin = base.velocity + relative, base.spin + own[3:]
        if self._forward:
            spins, arm_velocity = (base.spin, spin), ca.cross(spin, place.arm)
        else:
            spins, arm_velocity = (spin, base.spin), relative - ca.cross(base.spin, place.lever)
        rate = self._of_child(self._rate(place.frames, spins), place)
        centripetal = ca.cross(base.spin, relative) + ca.cross(own[3:], arm_velocity)
        turning = base.outward[3:, :]
        transport = base.outward[:3, :] - ca.mtimes(rotation.skew(apart), turning)
        opened = self.joint.opened(self.space.pose, *place.frames)
        outward = ca.SX.eye(6)[:, : self.group.twist.numel()]
        return self._of_group(
            RigidMotion(base.place + apart, place.euler, place.axes, velocity, spin, outward),
            drift=rate + ca.vertcat(centripetal, ca.SX(3, 1)),
            transport=ca.vertcat(transport, turning),
            subspace=subspace,
            opening=self._of_child(opened, place),
        )

    @property
    def _forward(self) -> bool:
        """Whether the child is the second body of the joint."""
        return self.joint.ends()[1] is self.group

    @property
    def _sides(self) -> tuple[Point, ...]:
        """Points of the joint on the carrier and on the child."""
        return self.joint.end_frames()[:: 1 if self._forward else -1]

    def _relative_euler(self, q: ca.SX) -> ca.SX:
        """(4,) Euler parameters of the child relative to its carrier, linear in those by q."""
        turn, (near, far) = ca.SX.sym("turn", 4), map(_euler, self._sides)
        along = rotation.product(turn, ca.SX(list(self.branch)))
        along = along if self._forward else rotation.conjugate(along)
        whole = rotation.product(rotation.product(near, along), rotation.conjugate(far))
        return ca.mtimes(ca.jacobian(whole, turn), self.joint.turned(q))

    def _placement(self, base: RigidMotion) -> Placement:
        near, far = self._sides
        euler, axes = AT_REST.euler, AT_REST.axes
        if self.group.rotates:
            euler = rotation.product(base.euler, self._relative_euler(self.space.pose))
            axes = rotation.matrix(euler)
        frames = [ca.mtimes(base.axes, _axes(near)), ca.mtimes(axes, _axes(far))]
        frames = frames[:: 1 if self._forward else -1]
        offset = self.joint.offset(self.space.pose, frames[0])
        return Placement(
            euler=euler,
            axes=axes,
            frames=frames,
            lever=ca.mtimes(base.axes, _arm(near)),
            offset=offset if self._forward else -offset,
            arm=-ca.mtimes(axes, _arm(far)),
        )

    def _of_child(self, motion: ca.SX, place: Placement) -> ca.SX:
        """Motion of the child's mass centre from the relative motion of the joint's frames."""
        arm = place.arm if self._forward else place.offset + place.arm
        velocity = motion[:3, :] - ca.mtimes(rotation.skew(arm), motion[3:, :])
        return ca.vertcat(velocity, motion[3:, :]) * (1 if self._forward else -1)

    def _motion_subspace(self, frames: list[ca.SX]) -> ca.SX:
        """(6, k) motion subspace; empty for a particle, which has no rotation."""
        if not self.group.rotates:
            return ca.SX(6, 0)
        return self.joint.subspace(self.space.pose, *frames)

    def _rate(self, frames: list[ca.SX], spins: tuple[ca.SX, ca.SX]) -> ca.SX:
        """(6,) rate of ``S u`` at constant u, with axes that rotate with their bodies."""
        axes = [ca.SX.sym(name, 3, 3) for name in ("first", "second")]
        motion = ca.mtimes(self._motion_subspace(axes), self.space.twist)
        turning = [ca.mtimes(rotation.skew(w), a) for w, a in zip(spins, frames, strict=True)]
        state = ca.vertcat(*map(ca.vec, axes), self.space.pose)
        rate = ca.vertcat(*map(ca.vec, turning), self.space.pose_rate)
        motion_rate = ca.jtimes(motion, state, rate)
        return ca.densify(ca.substitute([motion_rate], axes, [ca.densify(x) for x in frames])[0])

    def _of_group(self, rigid: RigidMotion, **parts: ca.SX) -> Step:
        """Step in the coordinates of the body; a particle has velocities only."""
        n = self.group.twist.numel()
        projection, pose = ca.SX.eye(3), rigid.place
        if self.group.rotates:
            projection = ca.diagcat(projection, rigid.axes.T)
            pose = ca.vertcat(pose, rigid.euler)
        return Step(
            pose=pose,
            twist=ca.mtimes(projection, ca.vertcat(rigid.velocity, rigid.spin)[:n]),
            coupling=ca.SX(parts["subspace"].shape[1], parts["transport"].shape[1]),
            projection=projection,
            rigid=rigid,
            **{name: part[:n, :] for name, part in parts.items()},
        )


def spatial_link(joint: TreeJoint, carrier: Body, child: Body) -> SpatialLink:
    """The link of a child at either end of a joint."""
    space = joint.joint_space() if child.rotates else JointSpace((), (), ca.SX(0, 1))
    return SpatialLink(child, space, carrier, joint)


def _arm(point: Point) -> ca.SX:
    """(3,) vector from the mass centre, in the axes of the body."""
    return point.local.sx - (point.body.center_of_mass.sx if point.body.dimension == 3 else 0)


def _axes(point: Point) -> ca.SX:
    """(3, 3) axes of a frame, or of its body, in body axes."""
    return point.local_axes if isinstance(point, Frame) else ca.SX.eye(3)


def _euler(point: Point) -> ca.SX:
    return rotation.from_matrix(ca.densify(_axes(point)))
