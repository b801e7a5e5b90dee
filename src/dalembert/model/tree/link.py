"""Links of a kinematic tree: a group of coordinates and its motion relative to its carrier."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.joint_space import JointSpace
from dalembert.symbolic import rotation


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
