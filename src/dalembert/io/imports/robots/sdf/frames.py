"""Poses of links, joints and frames of an SDF model."""

from __future__ import annotations

import math

import numpy as np

from dalembert.io.imports.robots.pose import Pose, quaternion_axes, roll_pitch_yaw
from dalembert.io.imports.xml.element import XmlElement

MODEL, WORLD = "__model__", "world"
SCOPE = "::"
FORMATS = ("euler_rpy", "quat_xyzw")


class Frames:
    """Frames of a model by name, each relative to another one.

    Parameters
    ----------
    element : ``<model>``
    pose : of the model in the world
    """

    def __init__(self, element: XmlElement, pose: Pose):
        self.element = element
        self.resolved: dict[str, Pose] = {MODEL: pose, WORLD: Pose(), "": pose}
        self.pending: dict[str, tuple[XmlElement, str]] = {}
        self.inner: dict[str, Frames] = {}
        self._open: list[str] = []

    def add(self, element: XmlElement, default: str) -> None:
        """A link, joint or frame, whose pose is relative to another frame by default."""
        name = element.text("name")
        if name in self.pending or name in self.resolved:
            raise element.error("a frame of this name exists already; rename one of them")
        self.pending[name] = element, default

    def of(self, name: str, element: XmlElement) -> Pose:
        """Pose of a frame in the world.

        Raises
        ------
        ModelError
            Unknown, or relative to itself.
        """
        if name in self.resolved:
            return self.resolved[name]
        first, scope, rest = name.partition(SCOPE)
        if scope and first in self.inner:
            return self.inner[first].of(rest, element)
        if name not in self.pending:
            known = ", ".join([*self.pending][:12])
            raise element.error(f"there is no frame {name!r}; this model has: {known}")
        if name in self._open:
            cycle = " → ".join([*self._open, name])
            raise element.error(f"frames are relative to each other in a cycle: {cycle}")
        self._open.append(name)
        owner, default = self.pending[name]
        pose = self.pose(owner, default)
        self._open.pop()
        self.resolved[name] = pose
        return pose

    def pose(self, element: XmlElement, default: str) -> Pose:
        """Pose in the world of the child ``<pose>`` of an element."""
        child = element.only("pose")
        if child is None:
            return self.of(default, element)
        base = child.text("relative_to", child.text("frame", "")) or default
        return self.of(base, child) @ local_pose(child)


def local_pose(element: XmlElement | None) -> Pose:
    """Pose of a ``<pose>`` in the frame that it is relative to."""
    if element is None:
        return Pose()
    text = element.value()
    if not text:
        return Pose()
    kind = element.choice("rotation_format", FORMATS, "euler_rpy")
    unit = math.pi / 180 if element.flag("degrees", False) else 1.0
    if kind == "quat_xyzw":
        *place, x, y, z, w = element.content_numbers(7)
        if not any((x, y, z, w)):
            raise element.error("the quaternion is zero; a unit quaternion has the norm 1")
        return Pose(np.array(place), quaternion_axes([w, x, y, z]))
    numbers = element.content_numbers(6)
    return Pose(np.array(numbers[:3]), roll_pitch_yaw(*(unit * a for a in numbers[3:])))
