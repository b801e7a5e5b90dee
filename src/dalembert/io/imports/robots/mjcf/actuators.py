"""Actuators of MJCF as forces in joints with named inputs."""

from __future__ import annotations

from dalembert.io.imports.robots.mjcf.actuator_law import Law
from dalembert.io.imports.robots.mjcf.bodies import MjcfBodies
from dalembert.io.imports.robots.parts import Actuator, Joint
from dalembert.io.imports.xml.element import XmlElement

CONVERTED = ("general", "motor", "position", "velocity", "damper")
OTHER_PLACES = ("site", "body", "slidersite", "cranksite", "refsite", "geom")
"""Attributes that name what an actuator acts on, besides joints and tendons."""
LIMITS = {"ctrl": "ctrlrange", "force": "forcerange"}


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
        joints = self._transmission(element)
        if joints is None or not all(joint.has_angle for joint, _ in joints):
            self._omit(element, "only actuators of hinges, slides and fixed tendons are converted")
            return
        if element.text("dyntype", "none") != "none":
            self._omit(element, "actuators with states are not converted; use a block")
            return
        name = element.attributes.get("name", f"{joints[0][0].name}_{element.tag}")
        gear = element.numbers("gear", default=(1.0,))[0]
        gain, bias = self._law(element)
        element.ignore("name", "class", "group", "user", "ctrllimited", "forcelimited")
        limited = element.attributes.get("ctrllimited", "auto") != "false"
        bounds = None
        if limited and element.has("ctrlrange"):
            low, high = element.numbers("ctrlrange", 2)
            bounds = (low, high) if low < high else None
        if element.has("inheritrange"):
            element.ignore("ctrlrange")
        transmission = [(joint, gear * coefficient) for joint, coefficient in joints]
        offset = sum(c * self.bodies.references[joint] for joint, c in transmission)
        self.actuators.append(Actuator(name, transmission, offset, gain, bias, bounds))

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

    def _law(self, element: XmlElement) -> tuple[list[float], list[float]]:
        """Coefficients ``g`` and ``b``.

        Actuators of all kinds share one default. Each element of its classes, then the actuator
        itself, changes the coefficients that it gives or that its kind implies.
        """
        law = Law()
        for own in (*reversed(element.defaults), element):
            law.change(own)
        if law.has_damping_ratio:
            law.bias[2] = 0.0
            reason = "is computed from the inertia; write kv"
            self.omissions.add(element, f"{element.tag} dampratio", reason)
        return law.coefficients
