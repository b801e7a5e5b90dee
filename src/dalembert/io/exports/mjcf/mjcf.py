"""MJCF files of mechanisms, for MuJoCo."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree import ElementTree as xml

from dalembert.elements.base import Constraint, ForceElement
from dalembert.elements.body import BodyElement
from dalembert.io.exports.exported import Files
from dalembert.io.exports.mjcf.bodies import add_body, euler
from dalembert.io.exports.mjcf.document import MjcfDocument, number, texts
from dalembert.io.exports.mjcf.forces import add_force
from dalembert.io.exports.mjcf.geoms import add_geoms
from dalembert.io.exports.mjcf.loops import (
    add_equality,
    add_halves,
    add_relations,
    shares_of_mass,
    split_bodies,
)
from dalembert.io.exports.rigid.tree import Motion, TreeBody, rigid_tree
from dalembert.model.graph.model import Model

STEP = 0.001
"""Time step of MuJoCo [s]."""


def mjcf_file(
    model: Model,
    name: str,
    parameters: Mapping[str, float] | None = None,
    step: float = STEP,
) -> Files:
    """An MJCF file of a mechanism of rigid bodies.

    Bodies are along a spanning tree, at their assembled start, the keyframe ``start``. Joints
    that close loops are equalities.

    Parameters
    ----------
    parameters : values other than those of the model
    step : time step of MuJoCo [s]

    Raises
    ------
    UnsupportedError
        A flexible body, or a moving one without mass.
    """
    tree = rigid_tree(model, "MJCF", parameters)
    document = MjcfDocument(tree)
    document.sections["compiler"].attrib |= {"angle": "radian", "inertiafromgeom": "false"}
    document.sections["option"].attrib |= {"timestep": number(step), "integrator": "RK4"}
    document.sections["option"].set("gravity", "0 0 0")
    xml.SubElement(document.sections["default"], "geom", contype="0", conaffinity="0", mass="0")
    halves = split_bodies(document)
    shares = shares_of_mass(halves)
    for body in tree.bodies:
        add_body(document, body, shares.get(body.name, 1.0))
    bodies = [*tree.bodies, *add_halves(document, halves)]
    add_relations(document)
    for constraint in tree.loops:
        if constraint.name not in halves:
            add_equality(document, constraint)
    for force in model.forces:
        add_force(force, document)
    for element in model.parts.elements.values():
        if not isinstance(element, BodyElement | Constraint | ForceElement):
            document.omit(element, type(element).__name__, "MuJoCo has no such element")
    add_geoms(document, parameters)
    _set_joint_attributes(document)
    _add_keyframe(document, bodies)
    return Files({f"{name}.xml": _text(document)}, document.omissions)


def _set_joint_attributes(document: MjcfDocument) -> None:
    for joint in document.root.iter("joint"):
        attributes = document.joint_attributes.get(joint.get("name", ""), {})
        joint.attrib |= texts({k: v for k, v in attributes.items() if v or k == "springref"})


def _add_keyframe(document: MjcfDocument, bodies: list[TreeBody]) -> None:
    """The assembled start with its speeds and controls; bodies in the order of the file."""
    positions: list[float] = []
    speeds: list[float] = []
    by_name = {body.name: body for body in bodies}
    for element in document.sections["worldbody"].iter("body"):
        body = by_name[element.get("name", "")]
        for motion in body.motions:
            positions += position_at_start(body, motion)
            speeds += motion.speed.tolist()
    attributes = {"name": "start", "qpos": positions, "qvel": speeds}
    attributes |= {"ctrl": document.ctrl} if document.ctrl else {}
    xml.SubElement(document.sections["keyframe"], "key", texts(attributes))


def position_at_start(body: TreeBody, motion: Motion) -> list[float]:
    """Coordinates of a motion at the start."""
    if motion.kind == "ball":
        return [1.0, 0.0, 0.0, 0.0]
    if motion.kind == "free":
        return [*body.position, *euler(body.axes)]
    return [motion.value]


def _text(document: MjcfDocument) -> bytes:
    """The file, with the omissions as comments."""
    for section in document.sections.values():
        if not len(section) and not section.attrib:
            document.root.remove(section)
    lines = [f" {document.model.name}, written by dalembert. "]
    lines += [f" not exported: {o} ".replace("--", "- -") for o in document.omissions]
    for line in reversed(lines):
        document.root.insert(0, xml.Comment(line))
    xml.indent(document.root)
    return xml.tostring(document.root, encoding="utf-8", xml_declaration=True)
