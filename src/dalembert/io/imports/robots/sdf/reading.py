"""Import of SDF: models of links and joints, with loops."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from dalembert.errors import FileError
from dalembert.io.imports.imported import Imported
from dalembert.io.imports.robots.parts import FREE, Closure, Dependence, Joint, Link, Robot
from dalembert.io.imports.robots.pose import Pose, axes_about
from dalembert.io.imports.robots.reader import Omissions, imported_robot
from dalembert.io.imports.robots.sdf.frames import MODEL, SCOPE, WORLD, Frames, local_pose
from dalembert.io.imports.robots.sdf.joints import KINDS, NOT_CONVERTED, SdfJoint, omit, read_joint
from dalembert.io.imports.robots.sdf.links import SdfShapes, link_inertia
from dalembert.io.imports.robots.sdf.values import flag, number, text
from dalembert.io.imports.xml.element import XmlElement
from dalembert.io.imports.xml.parsing import read_xml
from dalembert.io.imports.xml.resources import Resources

CLOSURES = {
    "revolute": "Revolute",
    "continuous": "Revolute",
    "prismatic": "Prismatic",
    "ball": "Spherical",
    "universal": "Universal",
    "fixed": "Weld",
}
"""Type of a joint → class of a joint that closes a loop."""
AXES = ("axis", "axis2")
GRAVITY = (0.0, 0.0, -9.8)
"""Default gravity of the format [m/s²]."""
REASONS = {
    "material": "colours are not part of a model file",
    "sensor": "measures need no sensors; use measures of bodies and joints",
    "plugin": "is for another program",
    "collision": "contacts are not created; add a Collisions element",
    "surface": "contacts are not created; add a Collisions element",
    "self_collide": "contacts are not created; add a Collisions element",
    "physics": "is an option of the solver of another program",
    "light": "colours, lights and cameras are not part of a model file",
    "effort": "forces are not limited; clip the formula of an actuator",
    "velocity": "speeds are not limited",
}


def read_sdf(
    path: Path,
    root: str | Path | None = None,
    packages: Mapping[str, str | Path] | None = None,
    stops: float | None = None,
    repair_inertia: bool = False,
) -> Imported:
    """The models in an SDF file, of one model or of a world.

    Parameters
    ----------
    path : of the file
    root : folder inside which all referenced files are; that of the file by default
    packages : name of a model → its folder
    stops : stiffness of elastic stops at the limits of joints [N m/rad] or [N/m]; none by default
    repair_inertia : whether moments of inertia that no body has are raised, instead of refused

    Raises
    ------
    FileError, ModelError
        Names file, line, element, value and a fix.
    """
    element = read_xml(path)
    if element.tag != "sdf":
        raise FileError(f"{path}: the root element is <{element.tag}>, expected <sdf>")
    reader = SdfReader(element, Resources(path, root, packages or {}))
    robot = reader.robot()
    return imported_robot(path, "SDF", robot, reader.omissions, reader.files, stops, repair_inertia)


class SdfReader:
    """Reader of the elements of a file."""

    def __init__(self, root: XmlElement, resources: Resources):
        self.root, self.resources, self.files = root, resources, [root]
        self.omissions = Omissions(REASONS)
        self.shapes = SdfShapes(resources, self.omissions)
        self.links: dict[str, Link] = {}
        self.poses: dict[str | None, Pose] = {None: Pose()}
        self.joints: list[SdfJoint] = []
        self.static: set[str] = set()
        self.attached: dict[str, str] = {}
        self._included: list[Path] = []

    def robot(self) -> Robot:
        """All parts of the file."""
        self.root.visited = True
        self.root.ignore(*self.root.attributes)
        owners = self.root.all("world") or [self.root]
        models: list[XmlElement] = []
        gravity, name = np.array(GRAVITY), self.root.file.stem
        for owner in owners:
            owner.ignore("name")
            if (element := owner.only("gravity")) is not None:
                gravity = np.array(element.content_numbers(3))
            models += [*owner.all("model"), *self._includes(owner)]
        alone = len(models) == 1
        for model in models:
            title = model.text("name")
            name = title if alone else name
            prefix = "" if alone else f"{title}_"
            self._model(model, prefix, local_pose(model.only("pose")), False)
        if not self.links:
            raise self.root.error("has no <link>; a model has at least one")
        robot = Robot(name, gravity)
        robot.links = self._tree(robot)
        motions = {joint.name: joint for entry in self.joints for joint in entry.joints}
        for entry in self.joints:
            for joint, mimic in entry.mimics:
                robot.dependences.append(_mimic(joint, mimic, motions))
        return robot

    # models -----------------------------------------------------------------------------------
    def _includes(self, owner: XmlElement) -> list[XmlElement]:
        """Models of other files, with the names and poses that their includes give them."""
        models = []
        for include in owner.all("include"):
            uri = text(include, "uri")
            file = self._included_file(include, uri)
            root = read_xml(file)
            root.visited = True
            root.ignore(*root.attributes)
            self.files.append(root)
            model = root.needed("model")
            for tag in ("name", "pose", "static"):
                replacement = include.only(tag)
                if replacement is None:
                    continue
                if tag == "name":
                    model.attributes["name"] = replacement.value()
                else:
                    model.children = [c for c in model.children if c.tag != tag]
                    model.children.append(replacement)
            models.append(model)
        return models

    def _included_file(self, include: XmlElement, uri: str) -> Path:
        for ending in ("", "/model.sdf"):
            try:
                file = self.resources.find(uri + ending)
            except FileError as error:
                reason = error
                continue
            if file in self._included or file == self.resources.path.resolve():
                raise include.error(f"{file.name} is included a second time; copy its model")
            self._included.append(file)
            return file
        raise include.error(str(reason))

    def _model(self, model: XmlElement, prefix: str, pose: Pose, is_static: bool) -> Frames:
        """Links and joints of a model and of the models in it."""
        model.visited = True
        model.ignore("name", "xmlns:xacro")
        is_static = flag(model, "static") or is_static
        frames = Frames(model, pose)
        links = model.all("link")
        for element in links:
            frames.add(element, MODEL)
        for frame in model.all("frame"):
            owner = frame.text("attached_to", "") or MODEL
            frames.add(frame, owner)
            self.attached[prefix + frame.text("name")] = prefix + owner.replace(SCOPE, "_")
        if links:
            first = model.text("canonical_link", links[0].text("name"))
            self.attached[prefix + MODEL] = prefix + first.replace(SCOPE, "_")
        joints = [j for j in model.all("joint") if not self._is_omitted(j)]
        for joint in joints:
            frames.add(joint, text(joint, "child"))
            child = text(joint, "child").replace(SCOPE, "_")
            self.attached[prefix + joint.text("name")] = prefix + child
        for inner in [*model.all("model"), *self._includes(model)]:
            name = inner.text("name")
            place = frames.pose(inner, MODEL)
            frames.inner[name] = self._model(inner, f"{prefix}{name}_", place, is_static)
        for element in links:
            name = prefix + element.text("name")
            if name in self.links:
                raise element.error("a link of this name exists already; rename one of them")
            link = Link(name, element, link_inertia(element))
            link.shapes = self.shapes.of_link(element)
            self.links[name] = link
            self.poses[name] = frames.of(element.text("name"), element)
            if is_static:
                self.static.add(name)
        for joint in joints:
            ends = self._end(joint, "parent", prefix), self._end(joint, "child", prefix)
            self.joints.append(read_joint(joint, prefix, ends, frames))
        return frames

    def _is_omitted(self, joint: XmlElement) -> bool:
        kind = joint.choice("type", [*KINDS, *NOT_CONVERTED])
        if kind in NOT_CONVERTED:
            omit(joint, self.omissions)
        return kind in NOT_CONVERTED

    def _end(self, joint: XmlElement, tag: str, prefix: str) -> str | None:
        name = text(joint, tag)
        if name == WORLD:
            return None
        full, visited = prefix + name.replace(SCOPE, "_"), set()
        while full in self.attached and full not in visited:
            visited.add(full)
            full = self.attached[full]
        if full not in self.links:
            raise joint.error(f"{tag} is {name!r}, which is no link or frame of this model")
        return full

    # tree -------------------------------------------------------------------------------------
    def _tree(self, robot: Robot) -> list[Link]:
        """Links, parents first; joints beyond a tree close loops."""
        children = {joint.child for joint in self.joints}
        roots = [n for n in self.links if n in self.static or n not in children]
        ordered: list[Link] = []
        visited: set[str | None] = {None}
        carrying: set[SdfJoint] = set()
        queue: list[str | None] = [None]
        for root in (None, *roots, *self.links):
            if root is not None:
                if root in visited:
                    continue
                visited.add(root)
                ordered.append(self._root(root))
                queue = [root]
            while queue:
                base = queue.pop(0)
                for joint in self.joints:
                    if joint.parent == base and joint.child not in visited:
                        visited.add(joint.child)
                        carrying.add(joint)
                        ordered.append(self._carried(joint))
                        queue.append(joint.child)
        robot.closures = [self._closure(j) for j in self.joints if j not in carrying]
        return ordered

    def _root(self, name: str) -> Link:
        """A link without a carrying joint: part of the ground, or free."""
        link = self.links[name]
        link.pose = self.poses[name]
        if name not in self.static:
            link.joints = [Joint(f"{name}_free", FREE, link.element)]
            link.start = link.pose
        return link

    def _carried(self, joint: SdfJoint) -> Link:
        assert joint.child is not None
        link = self.links[joint.child]
        link.parent = None if joint.parent is None else self.links[joint.parent]
        link.pose = self.poses[joint.parent].inverse @ self.poses[joint.child]
        link.joints = joint.placed(self.poses[joint.child])
        return link

    def _closure(self, joint: SdfJoint) -> Closure:
        if joint.type not in CLOSURES:
            raise joint.element.error(f"a {joint.type} joint does not close a loop; cut another")
        first, second = joint.parent, joint.child
        links = self.links.get(first or ""), self.links.get(second or "")
        axes = [joint.axes[0], joint.axes[-1]] if joint.axes else [np.array([0.0, 0.0, 1.0])] * 2
        frames = [Pose(joint.pose.place, axes_about(axis)) for axis in axes]
        poses = self.poses[first].inverse @ frames[0], self.poses[second].inverse @ frames[1]
        motion = joint.joints[0] if len(joint.joints) == 1 else None
        return Closure(joint.name, CLOSURES[joint.type], joint.element, links, poses, {}, motion)


def _mimic(joint: Joint, mimic: XmlElement, motions: dict[str, Joint]) -> Dependence:
    """``s = multiplier (s_i − reference) + offset``."""
    name, axis = mimic.text("joint"), mimic.choice("axis", AXES, AXES[0])
    first = motions.get(name) or motions.get(f"{name}_{1 + AXES.index(axis)}")
    if first is None or first is joint:
        raise mimic.error(f"joint is {name!r}, expected another joint of this file")
    multiplier, offset = number(mimic, "multiplier", 1.0), number(mimic, "offset", 0.0)
    constant = offset - multiplier * number(mimic, "reference", 0.0)
    joint.start = constant + multiplier * first.start
    return Dependence(f"{joint.name}_mimic", mimic, first, joint, [constant, multiplier])
