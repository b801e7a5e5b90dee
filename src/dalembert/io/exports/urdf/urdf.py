"""URDF files of mechanisms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np

from dalembert.elements.base import Constraint, ForceElement
from dalembert.elements.body import BodyElement
from dalembert.elements.joint_forces import JointFriction
from dalembert.elements.loads import Gravity
from dalembert.io.exports.exported import Files
from dalembert.io.exports.rigid.chain import ChainJoint, Frame, chain_of
from dalembert.io.exports.rigid.kinematics import TreeKinematics
from dalembert.io.exports.rigid.tree import RigidTree, TreeBody, rigid_tree
from dalembert.io.exports.shapes.scene import scene_size, start_recording
from dalembert.io.exports.shapes.stl import stl_file
from dalembert.io.exports.shapes.surfaces import surface_of
from dalembert.io.exports.urdf.loops import add_loops
from dalembert.io.exports.urdf.numbers import numbers, origin
from dalembert.io.omission import Omission
from dalembert.model.graph.model import Model
from dalembert.results.pictures.scene import motion_scene

KINDS = {"hinge": "continuous", "slide": "prismatic", "free": "floating", "fixed": "fixed"}
WORLD = "world"
FAR = 1e6
"""Limits of displacements, which URDF requires [m]; of forces and speeds."""


def urdf_file(model: Model, name: str, parameters: Mapping[str, float] | None = None) -> Files:
    """A URDF file of a mechanism of rigid bodies, with meshes of their shapes.

    Links have the axes of the bodies, with the origin at their joint. Joints with several freedoms
    are chains of single ones. The values of the coordinates at the start are comments.

    Parameters
    ----------
    parameters : values other than those of the model

    Raises
    ------
    UnsupportedError
        A flexible body.
    """
    tree = rigid_tree(model, "URDF", parameters)
    root = xml.Element("robot", name=model.name)
    xml.SubElement(root, "link", name=WORLD)
    omissions = _omissions(tree)
    friction = _friction(tree, omissions)
    shapes, files = _shapes(model, name, parameters)
    offsets, starts = {"ground": np.zeros(3)}, []
    for body in tree.bodies:
        chain = chain_of(body, offsets[body.parent])
        parent = WORLD if body.parent == "ground" else body.parent
        for k, joint in enumerate(chain.joints):
            last = k == len(chain.joints) - 1
            child = body.name if last else f"{joint.name}.link"
            _add_joint(root, joint, parent, child, friction.get(joint.name, {}))
            if not last:
                xml.SubElement(root, "link", name=child)
            parent = child
            if joint.kind in ("hinge", "slide"):
                starts.append(f"{joint.name} = {joint.value:.12g}")
        _add_link(root, body, chain.offset, shapes.get(body.name, ()))
        offsets[body.name] = chain.offset
    omissions += add_loops(root, tree, offsets, WORLD)
    _add_meshes(root.find("link"), np.zeros(3), shapes.get("ground", ()))
    comments = [f" {model.name}, written by dalembert. ", f" start: {', '.join(starts)} "]
    comments += [f" not exported: {o} ".replace("--", "- -") for o in omissions]
    for line in reversed(comments):
        root.insert(0, xml.Comment(line))
    xml.indent(root)
    text = xml.tostring(root, encoding="utf-8", xml_declaration=True)
    return Files({f"{name}.urdf": text, **files}, omissions)


def _omissions(tree: RigidTree) -> list[Omission]:
    """Constraints, forces and other elements that URDF does not have."""
    model, result = tree.start.model, []
    for body in tree.bodies:
        for motion in body.motions:
            if motion.kind == "ball":
                reason = "three joints about x, y and z; they are singular where the second is ±90°"
                result.append(Omission(motion.name, "spherical joint", reason))
    for element in model.parts.elements.values():
        kind = type(element).__name__
        if isinstance(element, BodyElement | Constraint | JointFriction):
            continue
        reason = "URDF has no forces" if isinstance(element, ForceElement) else "no such element"
        result.append(Omission(element.name, kind, reason))
    for force in model.forces:
        if isinstance(force, Gravity):
            reason = "programs that read URDF have their own"
            result.append(Omission("gravity", "gravity", reason))
    return result


def _friction(tree: RigidTree, omissions: list[Omission]) -> dict[str, dict[str, float]]:
    """Coordinate → damping and dry friction of its joint."""
    kinematics = TreeKinematics(tree)
    table: dict[str, dict[str, float]] = {}
    for force in tree.start.model.forces:
        if not isinstance(force, JointFriction):
            continue
        relation = kinematics.affine(force.free_coordinate)
        values = [tree.start.constant(x.sx) for x in (force.viscous, force.coulomb)]
        indices: Any = [] if relation is None else np.flatnonzero(relation.coefficients[0])
        if relation is None or len(indices) != 1 or any(value is None for value in values):
            omissions.append(Omission(force.name, "friction", "it acts along no joint of the tree"))
            continue
        ratio = abs(relation.coefficients[0][indices[0]])
        viscous, coulomb = (float(value[0]) for value in values if value is not None)
        entry = table.setdefault(tree.motions[indices[0]].name, {"damping": 0.0, "friction": 0.0})
        entry["damping"] += viscous * ratio**2
        entry["friction"] += coulomb * ratio
    return table


def _add_joint(
    root: xml.Element, joint: ChainJoint, parent: str, child: str, friction: dict[str, float]
) -> None:
    element = xml.SubElement(root, "joint", name=joint.name, type=KINDS[joint.kind])
    xml.SubElement(element, "origin", origin(joint.origin))
    xml.SubElement(element, "parent", link=parent)
    xml.SubElement(element, "child", link=child)
    if joint.kind in ("hinge", "slide"):
        xml.SubElement(element, "axis", xyz=numbers(joint.axis))
    if joint.kind == "slide":
        far = numbers([FAR])
        xml.SubElement(element, "limit", lower=numbers([-FAR]), upper=far, effort=far, velocity=far)
    if friction:
        xml.SubElement(element, "dynamics", {k: numbers([v]) for k, v in friction.items()})


def _add_link(root: xml.Element, body: TreeBody, offset: np.ndarray, meshes: Any) -> None:
    element = xml.SubElement(root, "link", name=body.name)
    inertial = xml.SubElement(element, "inertial")
    place = Frame.shift(offset + body.body.center)
    xml.SubElement(inertial, "origin", origin(place))
    xml.SubElement(inertial, "mass", value=numbers([body.body.mass]))
    moments = body.body.inertia
    entries = {
        f"i{'xyz'[i]}{'xyz'[j]}": numbers([moments[i, j]]) for i in range(3) for j in range(i, 3)
    }
    xml.SubElement(inertial, "inertia", entries)
    _add_meshes(element, offset, meshes)


def _add_meshes(element: xml.Element | None, offset: np.ndarray, meshes: Any) -> None:
    """Shapes of a link as meshes."""
    assert element is not None
    for mesh in meshes:
        visual = xml.SubElement(element, "visual")
        xml.SubElement(visual, "origin", origin(Frame.shift(offset)))
        geometry = xml.SubElement(visual, "geometry")
        xml.SubElement(geometry, "mesh", filename=mesh)


def _shapes(
    model: Model, name: str, parameters: Mapping[str, float] | None
) -> tuple[dict[str, list[str]], dict[str, bytes]]:
    """Names of the meshes of each body, and their files."""
    scene = motion_scene(start_recording(model, parameters), np.zeros(1, int), loads=False)
    size, names, files = scene_size(scene), {}, {}
    for entry in [{"name": "ground", **scene["ground"]}, *scene["bodies"]]:
        surfaces = [surface_of(shape, size) for shape in entry["shapes"]]
        solids = [surface for surface in surfaces if surface is not None]
        if solids:
            file = f"{name}_{entry['name']}.stl"
            files[file] = stl_file(solids)
            names[entry["name"]] = [file]
    return names, files
