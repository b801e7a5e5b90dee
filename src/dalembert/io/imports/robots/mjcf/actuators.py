"""Actuators of MJCF as forces in joints with named inputs."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from dalembert.io.imports.robots.mjcf.actuator_law import Law
from dalembert.io.imports.robots.mjcf.bodies import MjcfBodies
from dalembert.io.imports.robots.mjcf.reference_inertia import ReferenceInertia
from dalembert.io.imports.robots.parts import Actuator, Joint, Link
from dalembert.io.imports.robots.pose import Pose
from dalembert.io.imports.xml.element import XmlElement

CONVERTED = ("general", "motor", "position", "velocity", "damper")
OTHER_PLACES = ("body", "slidersite", "cranksite", "refsite", "geom")
"""Attributes that name what an actuator acts on, besides joints, tendons and sites."""
ACTIVATIONS = {"none": "", "integrator": "integrator", "filter": "filter", "filterexact": "filter"}


class MjcfActuators:
    """Reader of the section ``<actuator>``.

    The force of an actuator on its transmission of length L is ``(g₀ + g₁ L + g₂ L̇) u + b₀ + b₁ L +
    b₂ L̇`` with the control u; L is the sum of the coordinates of joints times coefficients.

    Parameters
    ----------
    bodies : MjcfBodies

    Attributes
    ----------
    actuators : list
    """

    def __init__(self, bodies: MjcfBodies):
        self.bodies, self.omissions = bodies, bodies.source.omissions
        self.tendons = self._tendons()
        self.actuators: list[Actuator] = []
        for section in bodies.source.sections("actuator"):
            for element in section.children:
                self._add(element)

    def _tendons(self) -> dict[str, list[tuple[str, float]]]:
        """Name of a fixed tendon → names of joints and coefficients."""
        tendons = {}
        for section in self.bodies.source.sections("tendon"):
            for tendon in section.children:
                if tendon.tag == "fixed" and "name" in tendon.attributes:
                    tendons[tendon.attributes["name"]] = [
                        (child.attributes.get("joint", ""), child.number("coef"))
                        for child in tendon.children
                        if child.tag == "joint"
                    ]
        return tendons

    def _add(self, element: XmlElement) -> None:
        if element.tag not in CONVERTED:
            reason = "this kind of actuator is not converted; write its formula as JointActuator"
            self._omit(element, reason)
            return
        self.bodies.source.with_defaults(element, None)
        joints, site = self._transmission(element), self._site(element)
        if joints is None or not all(joint.has_angle for joint, _ in joints):
            reason = "only actuators of hinges, slides, fixed tendons and sites are converted"
            self._omit(element, reason)
            return
        activation = self._activation(element)
        if activation is None:
            self._omit(element, "this kind of activation is not converted; use a block")
            return
        owner = element.text("site") if site is not None else joints[0][0].name
        name = element.attributes.get("name", f"{owner}_{element.tag}")
        wrench = np.array([*element.numbers("gear", default=(1.0,)), *[0.0] * 6])[:6]
        gear = float(wrench[0])
        transmission = [(joint, gear * coefficient) for joint, coefficient in joints]
        gain, bias = self._law(element, transmission)
        element.ignore("name", "class", "group", "user")
        forces = self._limits(element, "forcerange", "forcelimited")
        bounds: tuple[float, float] | None
        if element.number("inheritrange", 0.0) and element.has("joint"):
            element.ignore("ctrlrange", "ctrllimited")
            bounds = self._inherited(element, joints[0][0])
        else:
            bounds = self._limits(element, "ctrlrange", "ctrllimited")
        offset = sum(c * self.bodies.references[joint] for joint, c in transmission)
        kind, constant = activation
        own = Actuator(name, transmission, offset, gain, bias, bounds, forces, kind, constant)
        own.site, own.wrench = site, wrench
        self.actuators.append(own)

    def _site(self, element: XmlElement) -> tuple[Link, Pose] | None:
        """Link and pose of a site on which an actuator acts."""
        if not element.has("site") or element.has("refsite"):
            return None
        name = element.text("site")
        if name not in self.bodies.sites:
            raise element.error(f"there is no site {name!r}; add it, or correct the name")
        link, pose = self.bodies.sites[name]
        return None if link is None else (link, pose)

    def _activation(self, element: XmlElement) -> tuple[str, float] | None:
        """Kind of the activation, which replaces the control, and its time constant."""
        if element.tag == "position":
            constant = element.number("timeconst", 0.0)
            return ("filter", constant) if constant > 0 else ("", 0.0)
        kind = ACTIVATIONS.get(element.text("dyntype", "none"))
        if kind is None:
            return None
        if not kind:
            return "", 0.0
        constant = [*element.numbers("dynprm"), 1.0][0] if element.has("dynprm") else 1.0
        if kind == "filter" and not constant > 0:
            raise element.error(f"dynprm is {constant:g}; the time constant is positive")
        return kind, constant

    @cached_property
    def _inertia(self) -> ReferenceInertia:
        return ReferenceInertia(self.bodies.links, self.bodies.positions())

    def _limits(self, element: XmlElement, *names: str) -> tuple[float, float] | None:
        limits = self.bodies.source.limits(element, *names)
        return limits if limits is not None and limits[0] < limits[1] else None

    def _inherited(self, element: XmlElement, joint: Joint) -> tuple[float, float]:
        """Bounds of the control: the limits of the joint about their middle, times a factor."""
        share = element.number("inheritrange")
        if joint.range is None:
            raise element.error(f"inheritrange: {joint.name} has no range; give it one")
        reference = self.bodies.references[joint]
        low, high = (limit + reference for limit in joint.range)
        middle, half = (low + high) / 2, share * (high - low) / 2
        return middle - half, middle + half

    def _omit(self, element: XmlElement, reason: str) -> None:
        element.visited = True
        element.ignore(*element.attributes)
        for child in element.children:
            child.visited = True
            child.ignore(*child.attributes)
        self.omissions.add(element, f"actuator {element.tag}", reason)

    def _transmission(self, element: XmlElement) -> list[tuple[Joint, float]] | None:
        """Joints with coefficients; None for another kind of transmission."""
        if any(element.has(place) for place in OTHER_PLACES):
            return None
        if element.has("site"):
            return [] if self._site(element) is not None else None
        if element.has("tendon"):
            named = self.tendons.get(element.text("tendon"))
            if named is None:
                return None
        else:
            key = "jointinparent" if element.has("jointinparent") else "joint"
            named = [(element.text(key), 1.0)]
        for name, _ in named:
            if name not in self.bodies.joints:
                raise element.error(f"there is no joint {name!r}; add it, or correct the name")
        return [(self.bodies.joints[name], coefficient) for name, coefficient in named]

    def _law(
        self, element: XmlElement, transmission: list[tuple[Joint, float]]
    ) -> tuple[list[float], list[float]]:
        """Coefficients ``g`` and ``b``.

        Actuators of all kinds share one default. Each element of its classes, then the actuator
        itself, changes the coefficients that it gives or that its kind implies.
        """
        law = Law()
        for own in (*reversed(element.defaults), element):
            law.change(own)
        if law.has_damping_ratio:
            inertia = self._inertia.along(transmission)
            law.bias[2] *= -2 * math.sqrt(law.gain[0] * inertia)
        return law.coefficients
