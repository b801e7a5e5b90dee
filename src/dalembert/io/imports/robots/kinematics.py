"""Poses of links in the bodies that carry them, and at the start."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from dalembert.io.imports.robots.parts import BALL, FREE, SLIDING, TURNING, Joint, Link, Robot
from dalembert.io.imports.robots.pose import Pose, axis_angle_axes


@dataclass(frozen=True, eq=False)
class Carrier:
    """A body with a frame in it.

    Attributes
    ----------
    link : whose joints move the body; None for the ground
    pose : in the frame of that link
    """

    link: Link | None
    pose: Pose


class Kinematics:
    """Poses of the links of a robot.

    Parameters
    ----------
    robot : Robot, whose links are parents first
    """

    def __init__(self, robot: Robot):
        self._carriers: dict[Link, Carrier] = {}
        self._fixed: dict[Link, list[tuple[Link, Pose]]] = defaultdict(list)
        self._world: dict[Link | None, Pose] = {None: Pose()}
        self._is_displaced: dict[Link | None, bool] = {None: False}
        self._steps: dict[Link, list[Pose]] = {}
        for link in robot.links:
            if link.joints:
                self._carriers[link] = Carrier(link, Pose())
            else:
                base = self.carrier(link.parent)
                self._carriers[link] = Carrier(base.link, base.pose @ link.pose)
            carrier = self._carriers[link]
            if carrier.link is not None:
                self._fixed[carrier.link].append((link, carrier.pose))
            self._place(link)
        self._need_starts(robot)

    def carrier(self, link: Link | None) -> Carrier:
        """The body that contains a link, and the frame of the link in it."""
        return Carrier(None, Pose()) if link is None else self._carriers[link]

    def fixed_to(self, link: Link) -> list[tuple[Link, Pose]]:
        """Links that form one body with a link, itself first, with their poses in its frame."""
        return self._fixed[link]

    def world(self, link: Link | None) -> Pose:
        """Pose of a link at the start."""
        return self._world[link]

    def starts(self, link: Link) -> list[Pose | None]:
        """Poses behind each joint of a link at the start; None if joints at zero determine them."""
        steps: list[Pose | None] = [*self._steps[link]]
        return steps if self._is_displaced[link] else [None] * len(steps)

    def _need_starts(self, robot: Robot) -> None:
        """State the poses of bodies in coupled joints, whose motions count from these."""
        coupled = {joint for d in robot.dependences for joint in (d.first, d.second)}
        for link in robot.links:
            if coupled.intersection(link.joints):
                for body in (link, self.carrier(link.parent).link):
                    self._is_displaced[body] = body is not None

    def _place(self, link: Link) -> None:
        displaced = self._is_displaced[link.parent]
        pose = self._world[link.parent] @ link.pose
        steps: list[Pose] = []
        for joint in link.joints:
            pose = pose @ motion(joint)
            displaced = displaced or bool(joint.start) or joint.kind in (BALL, FREE)
            steps.append(pose)
        if link.start is not None:
            is_free = link.joints and link.joints[0].kind == FREE
            pose = link.start if is_free else pose @ link.start
            displaced = True
            steps[-1:] = [pose]
        self._world[link], self._is_displaced[link] = pose, displaced
        self._steps[link] = steps


def motion(joint: Joint) -> Pose:
    """Displacement of the link by its joint at the start, in the frame before it."""
    if not joint.start:
        return Pose()
    direction = joint.axis / np.linalg.norm(joint.axis)
    if joint.kind == SLIDING:
        return Pose(joint.start * direction)
    assert joint.kind == TURNING
    axes = axis_angle_axes(direction, joint.start)
    return Pose(joint.anchor - axes @ joint.anchor, axes)
