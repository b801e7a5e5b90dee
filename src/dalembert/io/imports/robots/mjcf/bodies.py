"""Bodies, joints and frames of MJCF as links of a robot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.io.imports.robots.inertia import Inertia, combined
from dalembert.io.imports.robots.mjcf.geometry import Geom
from dalembert.io.imports.robots.mjcf.source import MjcfSource
from dalembert.io.imports.robots.parts import BALL, FREE, SLIDING, TURNING, Joint, Link, Shape
from dalembert.io.imports.robots.pose import Pose
from dalembert.io.imports.xml.element import XmlElement

KINDS = {"hinge": TURNING, "slide": SLIDING, "ball": BALL, "free": FREE}
"""Type of a joint → its kind."""
MOST_COPIES = 10_000
"""Upper limit of the copies of a replicated element."""
MOST_OF_ALL = 2 * MOST_COPIES
"""Upper limit of all copies, those of copies included."""


@dataclass(frozen=True)
class Place:
    """Where elements are read.

    Attributes
    ----------
    link : body that contains them; None for the world
    pose : of the frames around them, in the body
    default : name of the default class
    ending : of names, in copies
    """

    link: Link | None
    pose: Pose
    default: str | None
    ending: str = ""


class MjcfBodies:
    """Reader of the bodies of a file.

    Parameters
    ----------
    source : MjcfSource

    Attributes
    ----------
    links : parents first
    joints : name → joint, with the value of its coordinate in the position of the file
    references : joint → that value
    sites : name → (link, pose in it)
    """

    def __init__(self, source: MjcfSource):
        self.source = source
        self.links: list[Link] = []
        self.by_name: dict[str, Link] = {}
        self.joints: dict[str, Joint] = {}
        self.references: dict[Joint, float] = {}
        self.sites: dict[str, tuple[Link | None, Pose]] = {}
        self.ground_shapes: list[Shape] = []
        self.copies = 0
        self._geoms: dict[Link, list[Geom]] = {}
        self._inertials: dict[Link, tuple[XmlElement, Pose]] = {}
        self.meshes = self._meshes()
        self.rule = source.option("inertiafromgeom", "auto")
        low, high = [*source.option("inertiagrouprange", "0 5").split(), "5"][:2]
        self.groups = range(int(low), int(high) + 1)
        for world in source.sections("worldbody"):
            world.ignore("name")
            self._read(world, Place(None, Pose(), None))
        self._complete_inertias()

    def _meshes(self) -> dict[str, XmlElement]:
        meshes = {}
        for asset in self.source.sections("asset"):
            for mesh in asset.all("mesh"):
                self.source.with_defaults(mesh, None)
                file = mesh.attributes.get("file", "").replace("\\", "/")
                meshes[mesh.text("name", file.rpartition("/")[2].rpartition(".")[0])] = mesh
        return meshes

    # elements in a body or in the world -------------------------------------------------------
    def _read(self, owner: XmlElement, place: Place) -> None:
        for element in owner.children:
            if element.tag == "body":
                self._body(element, place)
            elif element.tag == "geom":
                self._geom(element, place)
            elif element.tag in ("joint", "freejoint"):
                self._joint(element, place)
            elif element.tag == "inertial" and place.link is not None:
                self._add_inertial(element, place.link, place.pose)
            elif element.tag == "site":
                self._site(element, place)
            elif element.tag == "frame":
                element.visited = True
                element.ignore("name")
                inside = self._inside(element, place, self.source.pose(element))
                self._read(element, inside)
            elif element.tag == "replicate":
                self._replicate(element, place)

    def _inside(self, element: XmlElement, place: Place, pose: Pose, ending: str = "") -> Place:
        default = element.optional("childclass") or place.default
        return Place(place.link, place.pose @ pose, default, place.ending + ending)

    def _replicate(self, element: XmlElement, place: Place) -> None:
        """Copies of the elements; copy k is turned by k times the angles.

        Each is displaced relative to the previous one, along the axes of that one.
        """
        element.visited = True
        count = element.integer("count")
        if not 0 < count <= MOST_COPIES:
            raise element.error(f"count is {count}; expected 1 to {MOST_COPIES}")
        self.copies += count
        if self.copies > MOST_OF_ALL:
            raise element.error(f"more than {MOST_OF_ALL} copies in all; replicate fewer elements")
        angles = np.array(element.numbers("euler", 3, default=(0.0, 0.0, 0.0)))
        step = np.array(element.numbers("offset", 3, default=(0.0, 0.0, 0.0)))
        separator, at = element.text("sep", ""), np.zeros(3)
        for k in range(count):
            number, pose = (
                f"{k:0{len(str(count - 1))}d}",
                Pose(at, self.source.euler((k * angles).tolist())),
            )
            self._read(element, self._inside(element, place, pose, f"{separator}{number}"))
            at = pose.at(step)

    def _body(self, element: XmlElement, place: Place) -> None:
        element.visited = True
        name = element.text("name", f"body_{len(self.links) + 1}") + place.ending
        if name in self.by_name:
            first = self.by_name[name].element.line
            raise element.error(f"a body of this name is in line {first} already; rename one")
        pose = place.pose @ self.source.pose(element)
        link = Link(name, element, parent=place.link, pose=pose)
        link.lift = element.number("gravcomp", 0.0)
        self.links.append(link)
        self.by_name[name] = link
        self._geoms[link] = []
        default = element.optional("childclass") or place.default
        self._read(element, Place(link, Pose(), default, place.ending))
        if link.joints and link.joints[0].kind == FREE:
            if len(link.joints) > 1 or link.parent is not None:
                raise element.error("a free joint is the only joint of a body of the world")
            link.start = link.pose

    def _geom(self, element: XmlElement, place: Place) -> None:
        self.source.with_defaults(element, place.default)
        geom = Geom(element, self.source, self.meshes, place.pose)
        shape = geom.shape()
        if shape is not None:
            (place.link.shapes if place.link is not None else self.ground_shapes).append(shape)
        if place.link is not None:
            self._geoms[place.link].append(geom)
        else:
            element.ignore("mass", "density")

    def _site(self, element: XmlElement, place: Place) -> None:
        self.source.with_defaults(element, place.default)
        element.ignore("class", "type", "size", "rgba", "material", "group", "fromto")
        name = element.optional("name")
        if name is not None:
            pose = place.pose @ self.source.pose(element)
            self.sites[name + place.ending] = place.link, pose
            if place.link is not None:
                place.link.frames[name + place.ending] = pose

    def _joint(self, element: XmlElement, place: Place) -> None:
        link, source = place.link, self.source
        if link is None:
            raise element.error("a joint is part of a body; the world has none")
        if element.tag == "joint":
            source.with_defaults(element, place.default)
            kind = KINDS[element.choice("type", list(KINDS), "hinge")]
        else:
            element.visited, kind = True, FREE
        name = element.optional("name")
        if name is None:
            count = len(link.joints)
            name = f"{link.name}_joint{count + 1 if count else ''}"
        elif place.ending:
            name += place.ending
        if name in self.joints:
            raise element.error("a joint of this name exists already; rename one of them")
        element.ignore("class", "group", "type", "pos", "align")
        axis = np.array(element.numbers("axis", 3, default=(0.0, 0.0, 1.0)))
        if not np.linalg.norm(axis) > 0:
            raise element.error("axis has no direction; give a vector such as 0 0 1")
        anchor = np.array(element.numbers("pos", 3, default=(0.0, 0.0, 0.0)))
        joint = Joint(name, kind, element, place.pose.turned(axis), place.pose.at(anchor))
        if kind in (TURNING, SLIDING):
            self._coordinate(element, joint, source.degree if kind == TURNING else 1.0)
        else:
            element.ignore("axis", "ref", "springref")
            joint.damping = element.number("damping", 0.0)
            if joint.damping < 0:
                raise element.error(f"damping is {joint.damping:g}; it is not negative")
            for name_ in ("stiffness", "armature", "frictionloss"):
                if element.has(name_) and element.number(name_):
                    reason = "is converted for hinges and slides only"
                    source.omissions.add(element, f"{element.tag} {name_}", reason)
        link.joints.append(joint)
        self.joints[joint.name] = joint

    def _coordinate(self, element: XmlElement, joint: Joint, unit: float) -> None:
        """Limits, spring, friction and rotor of a hinge or slide."""
        reference = element.number("ref", 0.0) * unit
        self.references[joint] = reference
        numbers = {
            name: element.number(name, 0.0)
            for name in ("stiffness", "damping", "frictionloss", "armature")
        }
        for name, number in numbers.items():
            if number < 0:
                raise element.error(f"{name} is {number:g}; it is not negative")
        joint.stiffness, joint.damping = numbers["stiffness"], numbers["damping"]
        joint.friction, joint.inertia = numbers["frictionloss"], numbers["armature"]
        joint.rest = element.number("springref", 0.0) * unit - reference
        limits = self.source.limits(element, "range", "limited")
        if limits is not None:
            joint.range = limits[0] * unit - reference, limits[1] * unit - reference
        efforts = self.source.limits(element, "actuatorfrcrange", "actuatorfrclimited")
        if efforts is not None and efforts[0] < efforts[1]:
            joint.effort_range = efforts

    # inertia ----------------------------------------------------------------------------------
    def _complete_inertias(self) -> None:
        """Inertia of every body, from ``<inertial>`` or its geoms, within the limits."""
        for link in self.links:
            inertial, around = self._inertials.get(link, (None, Pose()))
            if inertial is not None and self.rule != "true":
                link.inertia = self._inertial(inertial, around)
                for geom in self._geoms[link]:
                    geom.element.ignore("mass", "density")
            elif self.rule != "false":
                geoms = [g for g in self._geoms[link] if g.group in self.groups]
                link.inertia = combined(geom.inertia() for geom in geoms)
                if inertial is not None:
                    inertial.ignore(*inertial.attributes)
            link.inertia = self._limited(link)
        total = self.source.bound("settotalmass", -1.0)
        mass = sum(link.inertia.mass for link in self.links)
        if total > 0 and mass > 0:
            for link in self.links:
                own, factor = link.inertia, total / mass
                link.inertia = Inertia(own.mass * factor, own.center, own.tensor * factor)

    def _add_inertial(self, element: XmlElement, link: Link, pose: Pose) -> None:
        """The inertia of a body, in frames with this pose in the body."""
        element.visited = True
        if link in self._inertials:
            line = self._inertials[link][0].line
            raise element.error(f"the first <inertial> of {link.name} is in line {line}; keep one")
        self._inertials[link] = element, pose

    def _inertial(self, element: XmlElement, around: Pose) -> Inertia:
        pose, mass = around @ self.source.pose(element), element.number("mass")
        if mass < 0:
            raise element.error(f"mass is {mass:g} kg; it is not negative")
        if element.has("fullinertia"):
            xx, yy, zz, xy, xz, yz = element.numbers("fullinertia", 6)
            tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        else:
            tensor = np.diag(element.numbers("diaginertia", 3, default=(0.0, 0.0, 0.0)))
        return Inertia(mass, np.zeros(3), tensor).seen_from(pose)

    def _limited(self, link: Link) -> Inertia:
        """Inertia within ``boundmass``, ``boundinertia`` and, if required, balanced."""
        own, source = link.inertia, self.source
        least_mass, least = source.bound("boundmass", 0.0), source.bound("boundinertia", 0.0)
        if not (least_mass or least or source.is_on("balanceinertia", False)):
            return own
        values, axes = np.linalg.eigh(own.tensor)
        moments = np.maximum(values, least)
        if source.is_on("balanceinertia", False) and 2 * moments[-1] > moments.sum():
            moments = np.full(3, moments.mean())
        if np.array_equal(moments, values):
            return Inertia(max(own.mass, least_mass), own.center, own.tensor)
        tensor = axes @ np.diag(moments) @ axes.T
        return Inertia(max(own.mass, least_mass), own.center, tensor)

    def positions(self) -> dict[Link | None, Pose]:
        """Poses of all bodies in the position of the file."""
        poses: dict[Link | None, Pose] = {None: Pose()}
        for link in self.links:
            poses[link] = poses[link.parent] @ link.pose
        return poses

    def end(self, element: XmlElement, name: str | None) -> Link | None:
        """The body of a name; None for the world."""
        if name is None or name == "world":
            return None
        if name not in self.by_name:
            raise element.error(f"there is no body {name!r}; add it, or correct the name")
        return self.by_name[name]
