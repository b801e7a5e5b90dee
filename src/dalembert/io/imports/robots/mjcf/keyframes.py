"""Keyframes of MJCF as initial positions."""

from __future__ import annotations

import numpy as np

from dalembert.errors import ModelError
from dalembert.io.imports.robots.mjcf.bodies import MjcfBodies
from dalembert.io.imports.robots.mjcf.source import MjcfSource
from dalembert.io.imports.robots.parts import BALL, FREE, Joint, Link
from dalembert.io.imports.robots.pose import Pose, quaternion_axes
from dalembert.text.wording import unknown

COUNTS = {FREE: 7, BALL: 4}
"""Kind of a joint → number of its coordinates; one for the others."""


def apply_keyframe(source: MjcfSource, bodies: MjcfBodies, name: str | None) -> None:
    """Set the initial coordinates of all joints to those of a keyframe.

    Raises
    ------
    ModelError
        Unknown name, or another number of coordinates.
    """
    if name is None:
        return
    keys = {
        key.attributes.get("name", str(k)): key
        for section in source.sections("keyframe")
        for k, key in enumerate(section.children)
    }
    if name not in keys:
        raise ModelError(unknown("keyframe", name, keys), str(source.path))
    key = keys[name]
    key.visited = True
    key.ignore("name")
    joints = [(link, joint) for link in bodies.links for joint in link.joints]
    count = sum(COUNTS.get(joint.kind, 1) for _, joint in joints)
    values = key.numbers("qpos", count)
    for link, joint in joints:
        own = values[: COUNTS.get(joint.kind, 1)]
        values = values[len(own) :]
        if joint.kind == FREE and _is_aligned(joint, link, source, bodies):
            raise joint.element.error(
                "align: the keyframe counts from the principal axes of the body, which are not "
                "converted; write align=false and its qpos for the frame of the body"
            )
        if joint.kind in (FREE, BALL):
            axes = quaternion_axes(own[-4:]) if any(own[-4:]) else np.eye(3)
            place = np.array(own[:3]) if joint.kind == FREE else joint.anchor - axes @ joint.anchor
            link.start = Pose(place, axes)
        else:
            joint.start = own[0] - bodies.references[joint]


def _is_aligned(joint: Joint, link: Link, source: MjcfSource, bodies: MjcfBodies) -> bool:
    """Whether the frame of a free body is moved to its principal axes of inertia."""
    value = joint.element.text("align", "auto")
    chosen = value == "true" or (value == "auto" and source.is_on("alignfree", False))
    return chosen and not any(other.parent is link for other in bodies.links)
