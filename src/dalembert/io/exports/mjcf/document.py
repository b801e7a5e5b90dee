"""An MJCF document: its sections, names, numbers and parts that it cannot express."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np

from dalembert.elements.point import Point
from dalembert.io.exports.rigid.kinematics import Affine, TreeKinematics
from dalembert.io.exports.rigid.tree import RigidTree
from dalembert.io.omission import Omission

STIFF = {"solref": "0.002 1", "solimp": "0.9999 0.9999 0.001"}
"""Softness of equality constraints; MuJoCo has no exact ones."""
SECTIONS = (
    *("compiler", "option", "default", "asset", "worldbody", "tendon", "equality"),
    *("actuator", "keyframe"),
)


class MjcfDocument:
    """Sections of an MJCF file.

    Parameters
    ----------
    tree : RigidTree

    Attributes
    ----------
    bodies : name → element of a body; the ground is the world
    joint_attributes : coordinate → attributes of its joint
    ctrl : values of the controls at the start
    omissions : parts that MuJoCo cannot express
    """

    def __init__(self, tree: RigidTree):
        self.tree, self.start, self.model = tree, tree.start, tree.start.model
        self.kinematics = TreeKinematics(tree)
        self.root = xml.Element("mujoco", model=self.model.name)
        self.sections = {name: xml.SubElement(self.root, name) for name in SECTIONS}
        self.bodies: dict[str, xml.Element] = {"ground": self.sections["worldbody"]}
        self.joint_attributes: dict[str, dict[str, float]] = {}
        self.ctrl: list[float] = []
        self.omissions: list[Omission] = []
        self._sites: dict[tuple, str] = {}

    def omit(self, element: Any, content: str, reason: str) -> None:
        """Record a part that the file does not contain."""
        self.omissions.append(Omission(element.name, content, reason))

    def add(self, section: str, tag: str, **attributes: Any) -> xml.Element:
        """Add an element to a section; numbers and arrays become texts, None is left out."""
        return xml.SubElement(self.sections[section], tag, texts(attributes))

    def body_name(self, body: Any) -> str | None:
        """Name in the file; None for the world."""
        return None if body.name == "ground" else body.name

    def place(self, point: Point) -> np.ndarray:
        """(3,) position of a point at the start."""
        (place,) = self.start.values(point.position.sx)
        return np.pad(place, (0, 3 - place.size))

    def site(self, point: Point) -> str:
        """Name of a site at a point."""
        return self.site_at(point.body.name, self.place(point), point.name)

    def site_at(self, body: str, place: np.ndarray, name: str = "") -> str:
        """Name of a site of a body at an inertial position at the start."""
        local = self.start.bodies[body].local(place)
        key = (body, tuple(np.round(local, 12)))
        if key not in self._sites:
            label = name or f"{body}.site{len(self._sites) + 1}"
            label = label if label not in self._sites.values() else f"{label}.site"
            self._sites[key] = label
            attributes = texts({"name": label, "pos": local, "size": self.size * 0.01})
            xml.SubElement(self.bodies[body], "site", attributes)
        return self._sites[key]

    @property
    def size(self) -> float:
        """Length of the mechanism [m]."""
        return float(self.model.scales.length) or 1.0

    def spatial_tendon(self, name: str, points: Iterable[Point], **attributes: Any) -> None:
        """Add a tendon along points."""
        tendon = self.add("tendon", "spatial", name=name, **attributes)
        for point in points:
            xml.SubElement(tendon, "site", site=self.site(point))

    def fixed_tendon(self, name: str, coefficients: np.ndarray, **attributes: Any) -> None:
        """Add a tendon whose length is a linear combination of coordinates."""
        tendon = self.add("tendon", "fixed", name=name, **attributes)
        for k in np.flatnonzero(coefficients):
            joint = self.tree.motions[k].name
            xml.SubElement(tendon, "joint", joint=joint, coef=number(coefficients[k]))

    def accumulate(self, coordinate: str, **attributes: float) -> None:
        """Add stiffness, damping or friction to a joint; ``springref`` is a weighted mean."""
        known = self.joint_attributes.setdefault(coordinate, {})
        if "stiffness" in attributes and known.get("stiffness"):
            total = known["stiffness"] + attributes["stiffness"]
            moments = known["stiffness"] * known["springref"]
            moments += attributes["stiffness"] * attributes.pop("springref")
            known["springref"] = moments / total if total else 0.0
        for key, value in attributes.items():
            known[key] = value if key == "springref" else known.get(key, 0.0) + value

    def affine(self, formula: Any) -> Affine | None:
        """A scalar formula as an affine one of the coordinates."""
        return self.kinematics.affine(formula)


def number(value: float) -> str:
    """Shortest text that returns the same number."""
    rounded = float(value) + 0.0
    return str(int(rounded)) if rounded == int(rounded) and abs(rounded) < 1e15 else repr(rounded)


def texts(attributes: dict[str, Any]) -> dict[str, str]:
    """Attributes as texts."""
    result = {}
    for key, value in attributes.items():
        if value is None:
            continue
        if isinstance(value, str):
            result[key] = value
        elif isinstance(value, bool):
            result[key] = "true" if value else "false"
        else:
            result[key] = " ".join(number(x) for x in np.ravel(np.asarray(value, dtype=float)))
    return result
