"""Links of a kinematic tree: free groups of coordinates, and planar bodies carried by joints.

Poses are ``y = g(q, z)`` (4.15), (7.7) with open-constraint coordinates z.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates, JointSpace
from dalembert.elements.planar.body import Body, Ground, rotation as plane_rotation
from dalembert.elements.planar.joint import TreeJoint
from dalembert.symbolic import rotation
from dalembert.symbolic.formulas.expression import stack


@dataclass(frozen=True, eq=False)
class RigidMotion:
    """Position and velocity of a body in inertial axes, as expressions of q and u.

    Attributes
    ----------
    place, velocity, spin : SX (3,) position and velocity of the mass centre, angular velocity
    euler, axes : SX (4,) Euler parameters, (3, 3) axes of the body
    outward : SX (6, n), ``[velocity; spin]`` of the twist in the recursion
    """

    place: ca.SX
    euler: ca.SX
    axes: ca.SX
    velocity: ca.SX
    spin: ca.SX
    outward: ca.SX


AT_REST = RigidMotion(
    ca.SX(3, 1),
    ca.SX(list(rotation.IDENTITY)),
    ca.SX.eye(3),
    ca.SX(3, 1),
    ca.SX(3, 1),
    ca.SX(6, 0),
)
"""Motion of the ground."""


@dataclass(frozen=True, eq=False)
class Step:
    """The motion of a link, and its operators in the recursion.

    Attributes
    ----------
    pose, twist : SX of the group, of q and u
    drift : SX, rate of the twist in the recursion at constant twist of the carrier and u
    transport, subspace, coupling, opening : SX ``X``, ``S``, ``N`` and ``E``
    projection : SX ``T``, twist in the recursion → ``v``
    rigid : motion as a carrier in space, if it can be one
    """

    pose: ca.SX
    twist: ca.SX
    drift: ca.SX
    transport: ca.SX
    subspace: ca.SX
    coupling: ca.SX
    opening: ca.SX
    projection: ca.SX
    rigid: RigidMotion | None = None


@dataclass(frozen=True, eq=False)
class Link:
    """A group of coordinates without a carrier; subclasses describe bodies carried by joints.

    Attributes
    ----------
    group : the moving coordinates
    space : joint coordinates q with their speeds u
    carrier, joint : None without a carrier
    """

    group: Coordinates
    space: JointSpace
    carrier: Any
    joint: Any

    @property
    def equation_count(self) -> int:
        """Number of equations of its joint, and of open-constraint coordinates."""
        return 0 if self.joint is None else self.joint.equations.numel()

    @property
    def branch_offset(self) -> ca.SX:
        """(4,) rotation of its joint's second frame from its orientation by q, from the poses.

        Equations may also be satisfied after a half turn about an axis of that frame, and Euler
        parameters of both signs are equivalent.
        """
        return ca.SX(list(rotation.IDENTITY))

    def on_branch(self, offset: np.ndarray) -> Link:
        """The link with q on the branch of an offset."""
        return self

    def step(self, carrier: Step | None) -> Step:
        """Motion as a function of q, u and the motion of the carrier; None on the ground."""
        symbols = ca.vertcat(self.group.pose, self.group.twist)
        own = ca.vertcat(self.space.pose, self.space.twist)
        n = self.space.twist.numel()
        return Step(
            pose=self.space.pose,
            twist=self.space.twist,
            drift=ca.SX(n, 1),
            transport=ca.SX(n, 0),
            subspace=ca.SX.eye(n),
            coupling=ca.SX(n, 0),
            opening=ca.SX(n, 0),
            projection=ca.SX.eye(n),
            rigid=_rigid_motion(self.group, symbols, own),
        )


def _rigid_motion(group: Coordinates, symbols: ca.SX, values: ca.SX) -> RigidMotion | None:
    if not isinstance(group, BodyElement) or group.dimension != 3:
        return None
    velocity = group.twist[:3]
    outward = ca.jacobian(ca.vertcat(velocity, group.turning), group.twist)
    axes = ca.horzcat(*(group.turned(ca.SX.eye(3)[:, k]) for k in range(3)))
    parts = [group.mass_center, group.orientation, axes, velocity, group.turning, outward]
    return RigidMotion(*ca.substitute(parts, [symbols], [values]))


def free_link(group: Coordinates) -> Link:
    """A link with its own coordinates as joint coordinates."""
    return Link(group, JointSpace.of(group), None, None)


@dataclass(frozen=True, eq=False)
class PlanarLink(Link):
    """A planar body with its joint.

    Attributes
    ----------
    carrier, joint : at most one end of the joint is the ground
    z : SX symbols, open-constraint coordinates
    own, own_value : SX symbols ``q*``, and their value as a function of the carrier's pose and q:
        q with the absolute angle in place of a relative one, which makes shorter recursions
    pose : SX of the carrier's pose, ``q*`` and z
    """

    carrier: Body
    joint: TreeJoint
    z: ca.SX
    own: ca.SX
    own_value: ca.SX
    pose: ca.SX

    def step(self, carrier: Step | None) -> Step:
        """The local motion as a function of q and ``q̇``, with the motion of the carrier."""
        parts, value = self._local(carrier is not None), self.own_value
        if carrier is not None:
            symbols = ca.vertcat(self.carrier.pose, self.carrier.twist)
            motion = ca.vertcat(carrier.pose, carrier.twist)
            *parts, value = ca.substitute([*parts, value], [symbols], [motion])
        pose, twist, drift, transport, subspace, coupling, opening = ca.substitute(
            parts, [self.own], [value]
        )
        projection = ca.SX.eye(self.group.twist.numel())
        return Step(pose, twist, drift, transport, subspace, coupling, opening, projection)

    def _local(self, carried_by_a_body: bool) -> list[ca.SX]:
        """Pose, twist, drift, ``X, S, N, E`` as functions of the carrier's motion."""
        empty, u = ca.SX(0, 1), self.space.twist
        base, speed = empty, empty
        if carried_by_a_body:
            base, speed = self.carrier.pose, self.carrier.twist
        closed = ca.SX.zeros(self.z.numel())
        opened = [self.pose, ca.jacobian(self.pose, self.z)]
        pose, opening = ca.substitute(opened, [self.z], [closed])
        sign, by_base = (ca.jacobian(self.own_value, x) for x in (self.space.pose, base))
        transport, along = ca.jacobian(pose, base), ca.jacobian(pose, self.own)
        own_rate = ca.mtimes(sign, u) + ca.mtimes(by_base, speed)
        twist = ca.mtimes(transport, speed) + ca.mtimes(along, own_rate)
        position, rate = ca.vertcat(base, self.own), ca.vertcat(speed, own_rate)
        drift = ca.SX.zeros(pose.numel())
        if position.numel():
            drift = ca.jtimes(twist, position, rate)
        subspace, coupling = ca.mtimes(along, sign), ca.mtimes(sign.T, by_base)
        return [ca.densify(pose), ca.densify(twist), drift, transport, subspace, coupling, opening]


def planar_link(joint: TreeJoint, carrier: Body, child: Body, absolute_angles: bool) -> PlanarLink:
    """The link of a child at either end of a joint."""
    forward = joint.ends()[1] is child
    base = ca.SX.zeros(3) if isinstance(carrier, Ground) else carrier.pose
    base_angle = base[2] if carrier.rotates else ca.SX(0)
    z = stack(ca.SX.sym(f"{joint.name}.z{k}") for k in range(joint.equations.numel()))
    free = joint.joint_coordinates()
    names = [f"{joint.name}.{name}" for name in free]
    reading, units = [s for s, _ in free.values()], [unit for _, unit in free.values()]
    turn, absolute = joint.fixed_turn(z), absolute_angles or not carrier.rotates
    turns = turn is None and child.rotates
    if turns:
        names.append(f"{child.name}.angle" if absolute else f"{joint.name}.angle")
        reading.append(child.pose_angle if absolute else joint.turn)
        units.append("rad")
    space = JointSpace(names, units, stack(reading))
    slides = space.pose[: len(free)]
    own, own_value, angle = slides, slides, ca.SX(0)
    if turn is not None:
        angle = base_angle + turn if forward else base_angle - turn
    if turns:
        spin, angle = space.pose[-1], ca.SX.sym(f"{child.name}.angle")
        relative = base_angle + spin if forward else base_angle - spin
        own = ca.vertcat(slides, angle)
        own_value = ca.vertcat(slides, spin if absolute else relative)
    on_base, on_child = (joint.point_i, joint.point_j)[:: 1 if forward else -1]
    opening = joint.opening(slides, z, base_angle if forward else angle)
    place = base[:2] + ca.mtimes(plane_rotation(base_angle), on_base.local.sx)
    place += opening if forward else -opening
    place -= ca.mtimes(plane_rotation(angle), on_child.local.sx)
    pose = ca.vertcat(place, angle) if child.rotates else place
    return PlanarLink(child, space, carrier, joint, z, own, own_value, pose)
