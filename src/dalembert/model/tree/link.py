"""One group of coordinates in the tree, and how it moves with what carries it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates, JointSpace
from dalembert.symbolic import rotation


@dataclass(frozen=True, eq=False)
class RigidMotion:
    """Where a body is and how it moves, in inertial axes, by q and u alone.

    Attributes
    ----------
    place, velocity, spin : SX (3,) of the mass centre, and the angular velocity
    euler, axes : SX (4,) its Euler parameters, (3, 3) the axes they stand for
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
"""That of the ground."""


@dataclass(frozen=True, eq=False)
class Step:
    """The motion of a link, and its operators in the recursion.

    Attributes
    ----------
    pose, twist : SX of the group, of q and u
    drift : SX, rate of the twist in the recursion beside those of the carrier's twist and of u
    carried, moved, turned, forced : SX ``X``, ``S``, ``N`` and ``E``
    seen : SX, ``v`` of the twist in the recursion
    rigid : as a carrier in space, where it can be one
    """

    pose: ca.SX
    twist: ca.SX
    drift: ca.SX
    carried: ca.SX
    moved: ca.SX
    turned: ca.SX
    forced: ca.SX
    seen: ca.SX
    rigid: RigidMotion | None = None


@dataclass(frozen=True, eq=False)
class Link:
    """A group of coordinates that no joint carries; those of a joint say how it places a body.

    Attributes
    ----------
    group : what moves
    space : joint coordinates q with their speeds u
    carrier, joint : None where no joint carries it
    """

    group: Coordinates
    space: JointSpace
    carrier: Any
    joint: Any

    @property
    def equation_count(self) -> int:
        """Equations of its joint, and open-constraint coordinates."""
        return 0 if self.joint is None else self.joint.equations.numel()

    @property
    def standing(self) -> ca.SX:
        """(4,) turn of its joint's second frame from where q puts it; of the poses.

        Equations may be satisfied after half a turn about an axis of that frame, too, and Euler
        parameters of both signs mean the same.
        """
        return ca.SX(list(rotation.IDENTITY))

    def on_branch(self, standing: np.ndarray) -> Link:
        """The same with q as they stand."""
        return self

    def step(self, carrier: Step | None) -> Step:
        """Motion by q and u, and by that of the carrier; None on the ground."""
        known = ca.vertcat(self.group.pose, self.group.twist)
        own = ca.vertcat(self.space.pose, self.space.twist)
        n = self.space.twist.numel()
        return Step(
            pose=self.space.pose,
            twist=self.space.twist,
            drift=ca.SX(n, 1),
            carried=ca.SX(n, 0),
            moved=ca.SX.eye(n),
            turned=ca.SX(n, 0),
            forced=ca.SX(n, 0),
            seen=ca.SX.eye(n),
            rigid=_seen_in_space(self.group, known, own),
        )


def _seen_in_space(group: Coordinates, symbols: ca.SX, values: ca.SX) -> RigidMotion | None:
    if not isinstance(group, BodyElement) or group.dimension != 3:
        return None
    velocity = group.twist[:3]
    outward = ca.jacobian(ca.vertcat(velocity, group.turning), group.twist)
    axes = ca.horzcat(*(group.turned(ca.SX.eye(3)[:, k]) for k in range(3)))
    parts = [group.mass_center, group.orientation, axes, velocity, group.turning, outward]
    return RigidMotion(*ca.substitute(parts, [symbols], [values]))


def free_link(group: Coordinates) -> Link:
    """With its own coordinates."""
    return Link(group, JointSpace.of(group), None, None)
