"""Closed loops and coupled joints in URDF.

Loops are the ``<constraint>`` elements proposed for the format (github.com/ros/urdfdom_headers,
pull request 108): two links, the origin of a frame in each, and an axis in each frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np

from dalembert.elements import planar, spatial
from dalembert.io.exports.rigid.chain import Frame
from dalembert.io.exports.rigid.joints import relation_of, sequence_of
from dalembert.io.exports.rigid.kinematics import TreeKinematics
from dalembert.io.exports.rigid.tree import RigidTree
from dalembert.io.exports.shapes.surfaces import axes_along
from dalembert.io.exports.urdf.numbers import numbers, origin
from dalembert.io.omission import Omission
from dalembert.symbolic.formulas.expression import stack

KINDS: dict[type, str] = {
    planar.Revolute: "revolute",
    planar.Prismatic: "prismatic",
    planar.Weld: "fixed",
    spatial.Revolute: "revolute",
    spatial.Prismatic: "prismatic",
    spatial.Universal: "universal",
    spatial.Spherical: "spherical",
    spatial.Weld: "fixed",
    spatial.Planar: "planar",
}
"""Joint → type of the constraint."""
PROPOSED = "closed by a <constraint>, a proposed element, which many programs ignore"


def add_loops(
    root: xml.Element, tree: RigidTree, offsets: Mapping[str, np.ndarray], world: str
) -> list[Omission]:
    """Add constraints and coupled joints; returns those that URDF does not have.

    Parameters
    ----------
    offsets : name of a body → its origin in the frame of its link
    """
    kinematics, omissions = TreeKinematics(tree), []
    joints = {joint.name: joint for joint in tree.start.model.constraints}
    screws = [joints[body.joint] for body in tree.bodies if body.joint]
    for constraint in [*(s for s in screws if relation_of(s) is not None), *tree.loops]:
        kind = type(constraint).__name__
        if type(constraint) in KINDS:
            _add_constraint(root, tree, constraint, offsets, world)
            omissions.append(Omission(constraint.name, f"{kind} in a loop", PROPOSED))
        elif not _add_mimic(root, tree, kinematics, constraint):
            reason = "URDF has trees of joints with fixed ratios of two"
            omissions.append(Omission(constraint.name, kind, reason))
    return omissions


def _add_constraint(
    root: xml.Element,
    tree: RigidTree,
    joint: Any,
    offsets: Mapping[str, np.ndarray],
    world: str,
) -> None:
    """Frames that coincide at the start, with the axis of the joint as z axis."""
    sequence = sequence_of(joint)
    assert sequence is not None
    axes = [motion.axis for motion in sequence.motions if motion.axis is not None]
    normal = joint.frame_i.axis if isinstance(joint, spatial.Planar) else None
    chosen = [normal] if normal is not None else axes[:2]
    place, *directions = tree.start.values(sequence.anchor.position.sx, *chosen)
    place = np.pad(place, (0, 3 - place.size))
    sides = [directions[0], directions[-1]] if directions else [np.array([0.0, 0.0, 1.0])] * 2
    element = xml.SubElement(root, "constraint", name=joint.name, type=KINDS[type(joint)])
    for side, body in zip(("parent", "child"), joint.ends(), strict=True):
        xml.SubElement(element, side, link=world if body.name == "ground" else body.name)
    for side, body, axis in zip(("parent", "child"), joint.ends(), sides, strict=True):
        rigid = tree.start.bodies[body.name]
        local = rigid.local(place) + offsets[body.name]
        frame = Frame(local, rigid.axes.T @ axes_along(axis))
        xml.SubElement(element, f"{side}_origin", origin(frame))
        xml.SubElement(element, f"{side}_axis", xyz="0 0 1")


def _add_mimic(
    root: xml.Element, tree: RigidTree, kinematics: TreeKinematics, constraint: Any
) -> bool:
    """State a ratio of two coordinates as ``<mimic>``; returns whether that was possible."""
    equations = relation_of(constraint)
    others = stack(group.pose for group in constraint.own_coordinates())
    relation = kinematics.affine(constraint.equations if equations is None else equations, others)
    rows = [] if relation is None else [row for row in relation.coefficients if np.any(row)]
    if len(rows) != 1 or np.count_nonzero(rows[0]) != 2:
        return False
    elements = {joint.get("name"): joint for joint in root.findall("joint")}
    indices = sorted(np.flatnonzero(rows[0]), key=lambda k: -abs(rows[0][k]))
    mimicked = {mimic.get("joint") for mimic in root.iter("mimic")}
    for second, first in (indices, indices[::-1]):
        names = tree.motions[second].name, tree.motions[first].name
        if any(elements[name].find("mimic") is not None for name in names) or names[0] in mimicked:
            continue
        ratio = -rows[0][first] / rows[0][second]
        offset = tree.motions[second].value - ratio * tree.motions[first].value
        values = {"multiplier": numbers([ratio]), "offset": numbers([offset])}
        xml.SubElement(elements[names[0]], "mimic", {"joint": names[1], **values})
        return True
    return False
