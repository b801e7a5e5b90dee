"""Import of URDF: a tree of links, with loops by the proposed ``<constraint>`` elements.

The constraints are those proposed for the format (github.com/ros/urdfdom_headers, pull request
108): ``parent`` and ``child`` links, the origin of a frame in each, and an axis in each frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from dalembert.errors import FileError
from dalembert.io.imports.imported import Imported
from dalembert.io.imports.robots.inertia import Inertia
from dalembert.io.imports.robots.parts import (
    FREE,
    PLANAR,
    SLIDING,
    TURNING,
    Closure,
    Dependence,
    Joint,
    Link,
    Robot,
)
from dalembert.io.imports.robots.pose import Pose, axes_about, quaternion_axes, roll_pitch_yaw
from dalembert.io.imports.robots.reader import Omissions, imported_robot
from dalembert.io.imports.robots.urdf_shapes import UrdfShapes
from dalembert.io.imports.xml.element import XmlElement
from dalembert.io.imports.xml.parsing import read_xml
from dalembert.io.imports.xml.resources import Resources

KINDS = {
    "revolute": TURNING,
    "continuous": TURNING,
    "prismatic": SLIDING,
    "planar": PLANAR,
    "floating": FREE,
    "fixed": "",
}
CLOSURES = {
    "revolute": "Revolute",
    "continuous": "Revolute",
    "prismatic": "Prismatic",
    "universal": "Universal",
    "spherical": "Spherical",
    "ball": "Spherical",
    "fixed": "Weld",
    "planar": "Planar",
}
"""Type of a constraint → class of the joint that closes the loop."""
ONE_COORDINATE = "is converted for joints with one limited coordinate only"
XACRO = "xacro:"
"""Start of the tags of templates."""
GRAVITY = (0.0, 0.0, -9.81)
"""Gravity of the simulators that read URDF [m/s²]; the format has none."""
REASONS = {
    "transmission": "actuators are not part of the mechanics; add a JointActuator or a DCMotor",
    "gazebo": "is for another program",
    "sensor": "measures need no sensors; use measures of bodies and joints",
    "material": "colours are not part of a model file",
    "limit.effort": "forces are not limited; clip the formula of an actuator",
    "limit.velocity": "speeds are not limited",
    "calibration": "is for the control of the robot",
    "safety_controller": "is for the control of the robot",
    "collision": "contacts are not created; add a Collisions element",
    "verbose": "is for another program",
}


def read_urdf(
    path: Path,
    root: str | Path | None = None,
    packages: Mapping[str, str | Path] | None = None,
    base: str = "fixed",
    gravity: bool = True,
    stops: float | None = None,
    repair_inertia: bool = False,
) -> Imported:
    """The model in a URDF file.

    Parameters
    ----------
    path : of the file
    root : folder inside which all referenced files are; that of the file by default
    packages : name of a package → its folder
    base : ``"fixed"``: the root link is part of the ground; ``"free"``: it moves freely
    gravity : whether gravity acts along −z
    stops : stiffness of elastic stops at the limits of joints [N m/rad] or [N/m]; none by default
    repair_inertia : whether moments of inertia that no body has are raised, instead of refused

    Raises
    ------
    FileError, ModelError
        Names file, line, element, value and a fix.
    """
    element = read_xml(path)
    if element.tag != "robot":
        raise FileError(f"{path}: the root element is <{element.tag}>, expected <robot>")
    if base not in ("fixed", "free"):
        raise FileError(f"{path}: base is {base!r}, expected 'fixed' or 'free'")
    _refuse_template(element)
    reader = UrdfReader(element, Resources(path, root, packages or {}), base == "free")
    robot = reader.robot(np.array(GRAVITY) if gravity else None)
    return imported_robot(path, "URDF", robot, reader.omissions, [element], stops, repair_inertia)


def _refuse_template(root: XmlElement) -> None:
    """Check that a file is no template of xacro."""
    pending = [root]
    while pending:
        element = pending.pop()
        pending += element.children
        marked = [v for v in element.attributes.values() if "${" in v or "$(" in v]
        if element.tag.startswith(XACRO) or marked:
            raise element.error(
                "the file is a template; convert it first, for example with: xacro "
                f"{root.file.name} > converted.urdf"
            )


class UrdfReader:
    """Reader of the elements of a file."""

    def __init__(self, root: XmlElement, resources: Resources, is_free: bool):
        self.root, self.is_free = root, is_free
        self.omissions = Omissions(REASONS)
        self.shapes = UrdfShapes(resources, self.omissions)
        self.links: dict[str, Link] = {}
        self.joints: dict[str, Joint] = {}
        self.fixed: set[str] = set()

    def robot(self, gravity: np.ndarray | None) -> Robot:
        """All parts of the file."""
        self.root.visited = True
        self.root.ignore("version", *(a for a in self.root.attributes if a.startswith("xmlns")))
        robot = Robot(self.root.text("name", self.root.file.stem), gravity)
        for element in self.root.all("link"):
            link = self.link(element)
            if link.name in self.links:
                first = self.links[link.name].element.line
                raise element.error(
                    f"a link of this name is in line {first} already; rename one of them"
                )
            self.links[link.name] = link
        if not self.links:
            raise self.root.error("has no <link>; a robot has at least one")
        joints = self.root.all("joint")
        for element in joints:
            self.joint(element)
        robot.links = self._ordered()
        for element in joints:
            mimic = element.only("mimic")
            if mimic is not None and element.text("name") not in self.fixed:
                robot.dependences += self.mimic(element, mimic)
        robot.closures = [self.constraint(e) for e in self.root.all("constraint")]
        return robot

    def _ordered(self) -> list[Link]:
        """Links, parents first; the root is fixed to the ground or free.

        Raises
        ------
        ModelError
            Several roots, or a cycle.
        """
        roots = [link for link in self.links.values() if link.parent is None]
        if len(roots) > 1:
            names = ", ".join(repr(r.name) for r in roots[:6])
            raise roots[1].element.error(
                f"{len(roots)} links have no parent joint ({names}); connect all but one of them"
            )
        children: dict[Link | None, list[Link]] = {}
        for link in self.links.values():
            children.setdefault(link.parent, []).append(link)
        ordered, position = list(roots), 0
        while position < len(ordered):
            ordered += children.get(ordered[position], [])
            position += 1
        if len(ordered) < len(self.links):
            reached = set(ordered)
            link = next(link for link in self.links.values() if link not in reached)
            raise link.element.error(
                "the joints that carry this link form a cycle; a loop is closed by a <constraint>, "
                "not by a joint"
            )
        root = ordered[0]
        if self.is_free and root.name != "world":
            root.joints = [Joint(f"{root.name}_free", FREE, root.element)]
            root.start = Pose()
        return ordered

    # elements ---------------------------------------------------------------------------------
    def link(self, element: XmlElement) -> Link:
        link = Link(element.text("name"), element)
        inertial = element.only("inertial")
        if inertial is not None:
            link.inertia = self.inertia(inertial)
        link.shapes = self.shapes.of_link(element)
        return link

    def inertia(self, element: XmlElement) -> Inertia:
        mass = element.needed("mass")
        number = mass.number("value")
        if number < 0:
            raise mass.error(f"value is {number:g} kg; a mass is not negative")
        table = element.only("inertia")
        tensor = np.zeros((3, 3))
        if table is not None:
            keys = (("ixx", 0, 0), ("iyy", 1, 1), ("izz", 2, 2))
            for name, i, j in (*keys, ("ixy", 0, 1), ("ixz", 0, 2), ("iyz", 1, 2)):
                default = None if i == j else 0.0
                tensor[i, j] = tensor[j, i] = table.number(name, default)
        return Inertia(number, np.zeros(3), tensor).seen_from(origin(element))

    def joint(self, element: XmlElement) -> None:
        name = element.text("name")
        kind = KINDS[element.choice("type", list(KINDS))]
        parent, child = (self._link(element, tag) for tag in ("parent", "child"))
        if child.parent is not None or child is parent:
            raise element.error(
                f"link {child.name!r} has a parent joint already, or is its own parent; a loop is "
                "closed by a <constraint>, not by a joint"
            )
        if name in self.joints or name in self.fixed:
            raise element.error("a joint of this name exists already; rename one of them")
        child.parent, child.pose = parent, origin(element)
        if not kind:
            self.fixed.add(name)
            for unused in element.all("axis", "limit", "dynamics", "mimic"):
                unused.ignore(*unused.attributes)
            return
        axis = self._axis(element, "axis", (1.0, 0.0, 0.0))
        joint = self.joints[name] = Joint(name, kind, element, axis)
        child.joints = [joint]
        self._dynamics(element, joint)

    def _dynamics(self, element: XmlElement, joint: Joint) -> None:
        limit = element.only("limit")
        if limit is not None:
            lower, upper = limit.number("lower", 0.0), limit.number("upper", 0.0)
            if element.text("type") in ("revolute", "prismatic"):
                joint.range = lower, upper
            else:
                for side in [s for s in ("lower", "upper") if s in limit.attributes]:
                    self.omissions.add(limit, f"limit {side}", ONE_COORDINATE)
        dynamics = element.only("dynamics")
        if dynamics is None:
            return
        joint.damping = dynamics.number("damping", 0.0)
        joint.friction = dynamics.number("friction", 0.0)
        for name, value in (("damping", joint.damping), ("friction", joint.friction)):
            if value < 0:
                raise dynamics.error(f"{name} is {value:g}; it is not negative")
            if value and not joint.has_angle:
                self.omissions.add(dynamics, f"dynamics {name}", ONE_COORDINATE)

    def mimic(self, element: XmlElement, mimic: XmlElement) -> list[Dependence]:
        """The dependence of a joint; none if the other joint does not exist."""
        name, second = mimic.text("joint"), self.joints[element.text("name")]
        first = self.joints.get(name)
        if first is None or not (first.has_angle and second.has_angle):
            reason = f"{name!r} is no turning or sliding joint of this file; the joint is free"
            self.omissions.add(mimic, "mimic", reason)
            mimic.ignore(*mimic.attributes)
            return []
        if first is second:
            raise mimic.error(f"joint is {name!r}, which is the joint itself; name another one")
        offset, multiplier = mimic.number("offset", 0.0), mimic.number("multiplier", 1.0)
        second.start = offset + multiplier * first.start
        return [Dependence(f"{second.name}_mimic", mimic, first, second, [offset, multiplier])]

    def constraint(self, element: XmlElement) -> Closure:
        """A joint that closes a loop, between a frame of each of two links."""
        kind = CLOSURES[element.choice("type", list(CLOSURES))]
        links = self._link(element, "parent"), self._link(element, "child")
        poses = []
        for side in ("parent", "child"):
            place = element.only(f"{side}_origin")
            pose = Pose() if place is None else _pose(place)
            axis = self._axis(element, f"{side}_axis", (0.0, 0.0, 1.0))
            poses.append(pose @ Pose(np.zeros(3), axes_about(axis)))
        return Closure(element.text("name"), kind, element, links, (poses[0], poses[1]))

    def _link(self, element: XmlElement, tag: str) -> Link:
        end = element.needed(tag)
        name = end.text("link")
        if name not in self.links:
            raise end.error(f"link is {name!r}, which is no link of this file; add it or rename it")
        return self.links[name]

    def _axis(
        self, element: XmlElement, tag: str, default: tuple[float, float, float]
    ) -> np.ndarray:
        axis = element.only(tag)
        vector = np.array(default if axis is None else axis.numbers("xyz", 3, default=default))
        if axis is not None and not np.linalg.norm(vector) > 0:
            raise axis.error("xyz has no direction; give an axis such as 0 0 1")
        return vector


def origin(element: XmlElement) -> Pose:
    """Pose of the child ``<origin>`` of an element."""
    place = element.only("origin")
    return Pose() if place is None else _pose(place)


def _pose(element: XmlElement) -> Pose:
    xyz = np.array(element.numbers("xyz", 3, default=(0.0, 0.0, 0.0)))
    if element.has("quat_xyzw"):
        x, y, z, w = element.numbers("quat_xyzw", 4)
        if not any((x, y, z, w)):
            raise element.error("quat_xyzw is zero; a unit quaternion has the norm 1")
        return Pose(xyz, quaternion_axes([w, x, y, z]))
    return Pose(xyz, roll_pitch_yaw(*element.numbers("rpy", 3, default=(0.0, 0.0, 0.0))))
