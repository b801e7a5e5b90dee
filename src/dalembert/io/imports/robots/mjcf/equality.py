"""Equality constraints of MJCF as joints that close loops, and couplings."""

from __future__ import annotations

import numpy as np

from dalembert.io.imports.robots.mjcf.bodies import MjcfBodies
from dalembert.io.imports.robots.parts import Closure, Dependence, Joint, Link
from dalembert.io.imports.robots.pose import Pose, quaternion_axes
from dalembert.io.imports.xml.element import XmlElement

SOFT = "constraints are exact, without compliance"
"""Reason for the omission of the parameters of soft constraints."""


class MjcfEqualities:
    """Reader of the section ``<equality>``.

    Parameters
    ----------
    bodies : MjcfBodies
    """

    def __init__(self, bodies: MjcfBodies):
        self.bodies, self.omissions = bodies, bodies.source.omissions
        self.positions = bodies.positions()
        self.closures: list[Closure] = []
        self.dependences: list[Dependence] = []
        for section in bodies.source.sections("equality"):
            for element in section.all("connect", "weld", "joint"):
                self._add(element)

    def _add(self, element: XmlElement) -> None:
        self.bodies.source.with_defaults(element, None)
        element.ignore("name", "class")
        if not element.flag("active", True):
            element.ignore(*element.attributes)
            reason = "it is not active in the file"
            self.omissions.add(element, f"equality {element.tag}", reason)
            return
        if element.tag == "joint":
            self.dependences.append(self._dependence(element))
        else:
            self.closures.append(self._closure(element))

    def _closure(self, element: XmlElement) -> Closure:
        """A point or a frame that two bodies have in common."""
        name = element.attributes.get("name", f"{element.tag}_{len(self.closures) + 1}")
        if element.has("site1") or element.has("site2"):
            (first, a), (second, b) = (self._site(element, key) for key in ("site1", "site2"))
        else:
            first = self.bodies.end(element, element.text("body1"))
            second = self.bodies.end(element, element.optional("body2"))
            relative = self.positions[first].inverse @ self.positions[second]
            if element.tag == "connect":
                a = Pose(np.array(element.numbers("anchor", 3)))
                b = relative.inverse @ a
                a, b = Pose(a.place), Pose(b.place)
            else:
                b = Pose(np.array(element.numbers("anchor", 3, default=(0.0, 0.0, 0.0))))
                a = self._relative_pose(element) or relative @ b
        if first is second:
            raise element.error("connects a body to itself; name two bodies")
        if element.tag == "connect":
            a, b = Pose(a.place), Pose(b.place)
        kind = "Spherical" if element.tag == "connect" else "Weld"
        return Closure(name, kind, element, (first, second), (a, b))

    def _relative_pose(self, element: XmlElement) -> Pose | None:
        """Pose of the anchor, with the axes of the second body, in the first; None if unstated."""
        if not element.has("relpose"):
            return None
        numbers = element.numbers("relpose", 7)
        if not any(numbers[3:]):
            return None
        return Pose(np.array(numbers[:3]), quaternion_axes(numbers[3:]))

    def _site(self, element: XmlElement, key: str) -> tuple[Link | None, Pose]:
        name = element.text(key)
        if name not in self.bodies.sites:
            raise element.error(f"{key} is {name!r}, which is no site of this file")
        return self.bodies.sites[name]

    def _joint(self, element: XmlElement, key: str) -> Joint:
        name = element.text(key)
        joint = self.bodies.joints.get(name)
        if joint is None or not joint.has_angle:
            raise element.error(f"{key} is {name!r}, which is no hinge or slide of this file")
        return joint

    def _dependence(self, element: XmlElement) -> Dependence:
        """``first − first₀ = Σ a_k (second − second₀)ᵏ``, from the position of the file."""
        dependent = self._joint(element, "joint1")
        other = self._joint(element, "joint2") if element.has("joint2") else None
        given = element.numbers("polycoef", default=(0.0, 1.0, 0.0, 0.0, 0.0))
        coefficients = (given + [0.0] * 5)[: 5 if other is not None else 1]
        while len(coefficients) > 2 and not coefficients[-1]:
            coefficients.pop()
        name = element.attributes.get("name", f"{dependent.name}_coupling")
        return Dependence(name, element, other, dependent, coefficients)
