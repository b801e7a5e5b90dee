"""Joints of SDF."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dalembert.io.imports.robots.parts import BALL, SLIDING, TURNING, Joint
from dalembert.io.imports.robots.pose import Pose
from dalembert.io.imports.robots.reader import Omissions
from dalembert.io.imports.robots.sdf.frames import MODEL, Frames
from dalembert.io.imports.robots.sdf.values import flag, number
from dalembert.io.imports.xml.element import XmlElement

KINDS = {
    "revolute": (TURNING,),
    "continuous": (TURNING,),
    "prismatic": (SLIDING,),
    "ball": (BALL,),
    "universal": (TURNING, TURNING),
    "revolute2": (TURNING, TURNING),
    "fixed": (),
}
"""Type of a joint → kinds of the joints in a row that it consists of."""
NOT_CONVERTED = ("screw", "gearbox")
UNLIMITED = 1e15
"""Threshold above which a limit is none."""


@dataclass(eq=False)
class SdfJoint:
    """A joint between two links.

    Attributes
    ----------
    type : in the file
    parent, child : full names of links; None for the world
    pose : of its frame in the world
    axes : directions of its axes in the world
    joints : its motions, whose axes are not set yet
    mimics : elements of couplings, with the motion that they prescribe
    """

    name: str
    type: str
    element: XmlElement
    parent: str | None
    child: str | None
    pose: Pose
    axes: list[np.ndarray]
    joints: list[Joint]
    mimics: list[tuple[Joint, XmlElement]] = field(default_factory=list)

    def placed(self, link: Pose) -> list[Joint]:
        """Its motions, with axes and anchor in the frame of the child link."""
        for joint, axis in zip(self.joints, self.axes, strict=False):
            joint.axis = link.inverse.turned(axis)
        for joint in self.joints:
            joint.anchor = link.inverse.at(self.pose.place)
        return self.joints


def read_joint(
    element: XmlElement, prefix: str, ends: tuple[str | None, str | None], frames: Frames
) -> SdfJoint:
    """A joint with its axes, limits, springs and friction."""
    name, kind = prefix + element.text("name"), element.text("type")
    pose = frames.of(element.text("name"), element)
    motions = KINDS[kind]
    tags = ("axis", "axis2")[: len(motions)]
    axes: list[np.ndarray] = []
    joints: list[Joint] = []
    mimics = []
    for k, motion in enumerate(motions):
        label = name if len(motions) == 1 else f"{name}_{k + 1}"
        joint = Joint(label, motion, element)
        joints.append(joint)
        if motion == BALL:
            axes.append(np.array([0.0, 0.0, 1.0]))
            continue
        axis = element.needed(tags[k])
        axes.append(_direction(axis, pose, frames))
        _dynamics(axis, joint, limited=kind != "continuous")
        if (mimic := axis.only("mimic")) is not None:
            mimics.append((joint, mimic))
    if kind == "fixed":
        element.all("axis")
    return SdfJoint(name, kind, element, *ends, pose, axes, joints, mimics)


def _direction(axis: XmlElement, pose: Pose, frames: Frames) -> np.ndarray:
    """Direction of an axis in the world."""
    xyz = axis.only("xyz")
    vector = np.array([0.0, 0.0, 1.0] if xyz is None else xyz.content_numbers(3))
    if not np.linalg.norm(vector) > 0:
        raise axis.error("xyz has no direction; give an axis such as 0 0 1")
    base = pose
    if flag(axis, "use_parent_model_frame"):
        base = frames.of(MODEL, axis)
    if xyz is not None and (frame := xyz.text("expressed_in", "")):
        base = frames.of(frame, xyz)
    direction: np.ndarray = base.turned(vector / np.linalg.norm(vector))
    return direction


def _dynamics(axis: XmlElement, joint: Joint, limited: bool) -> None:
    limit, dynamics = axis.only("limit"), axis.only("dynamics")
    lower, upper = number(limit, "lower", -1e16), number(limit, "upper", 1e16)
    if limited and max(abs(lower), abs(upper)) < UNLIMITED:
        joint.range = lower, upper
    joint.damping = number(dynamics, "damping", 0.0)
    joint.friction = number(dynamics, "friction", 0.0)
    joint.stiffness = number(dynamics, "spring_stiffness", 0.0)
    joint.rest = number(dynamics, "spring_reference", 0.0)
    for name in ("damping", "friction", "stiffness"):
        if getattr(joint, name) < 0:
            raise axis.error(f"the {name} is {getattr(joint, name):g}; it is not negative")


def omit(element: XmlElement, omissions: Omissions) -> None:
    """List a joint that is not converted."""
    element.visited = True
    element.ignore(*element.attributes)
    for child in element.children:
        _skip(child)
    kind = element.attributes["type"]
    cure = {"gearbox": "add a Coupling", "screw": "add a Screw"}[kind]
    omissions.add(element, f"joint {kind}", f"is not converted; {cure} between its links")


def _skip(element: XmlElement) -> None:
    element.visited = True
    element.ignore("", *element.attributes)
    for child in element.children:
        _skip(child)
