"""Sections of a model file from the links and joints of a robot.

A link without a joint is part of the body that carries it. Joints have a frame in both bodies, with
the name of the joint, whose z axis is that of the joint and whose x axis counts its angle.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.io.imports.robots.body_tables import BodyTables
from dalembert.io.imports.robots.joint_forces import (
    actuator_formula,
    free_damper,
    joint_forces,
    scaled,
    sum_of,
    within,
)
from dalembert.io.imports.robots.kinematics import Carrier
from dalembert.io.imports.robots.parts import (
    BALL,
    FREE,
    PLANAR,
    SLIDING,
    TURNING,
    Actuator,
    Closure,
    Dependence,
    Joint,
    Link,
    Robot,
)
from dalembert.io.imports.robots.pose import (
    Pose,
    axes_about,
    tidy,
)
from dalembert.io.imports.toml_text import number_text
from dalembert.io.omission import Omission
from dalembert.text.wording import visible

TYPES = {TURNING: "Revolute", SLIDING: "Prismatic", BALL: "Spherical", PLANAR: "Planar"}
COORDINATES = {TURNING: "angle", SLIDING: "displacement"}
"""Kind of a joint → measure of its coordinate."""
UNITS = {TURNING: "rad", SLIDING: "m"}


class RobotDocument(BodyTables):
    """Writer of the sections of a model file.

    Parameters
    ----------
    robot : Robot
    stops : stiffness of elastic stops at the limits of joints [N m/rad] or [N/m]; None for no stops
    repair_inertia : whether inertias that no body has are raised, instead of refused

    Attributes
    ----------
    document : sections as plain data
    joints : joint → name in the model file
    """

    def __init__(self, robot: Robot, stops: float | None, repair_inertia: bool):
        super().__init__(robot, repair_inertia)
        self.stops = stops
        self.efforts: dict[Joint, list[str]] = {}
        self.joints = {
            joint: self.names.add(joint.name, "joint")
            for link in self.bodies
            for joint in link.joints
            if joint.kind != FREE
        }
        self.document = self._document()

    def _document(self) -> dict[str, Any]:
        for link in self.bodies:
            self.add_body(link)
        for link in self.bodies:
            self._add_joints(link)
        for link in self.robot.links:
            self.add_fixed(link)
        for closure in self.robot.closures:
            self._add_closure(closure)
        for dependence in self.robot.dependences:
            self._add_dependence(dependence)
        for joint, name in self.joints.items():
            forces = joint_forces(joint, name, self.sections["joints"][name]["connect"])
            forces |= self._limits(joint, name)
            self._add_forces(name, forces)
        for link in self.robot.links:
            self._add_lift(link)
        for actuator in self.robot.actuators:
            self._add_actuator(actuator)
        for joint, names in self.efforts.items():
            self._limit_effort(joint, names)
        document: dict[str, Any] = {"format": 1, "name": visible(self.robot.name), "dimension": 3}
        if self.robot.gravity is not None:
            document["gravity"] = tidy(self.robot.gravity)
        if self.ground:
            document["ground"] = self.ground
        sections = {name: section for name, section in self.sections.items() if section}
        return document | sections | {"analysis": {"type": "Dynamics", "duration": 1.0}}

    def _add_forces(self, name: str, forces: dict[str, dict[str, Any]]) -> None:
        for ending, force in forces.items():
            self.sections["forces"][self.names.add(f"{name}_{ending}")] = force

    def _limits(self, joint: Joint, name: str) -> dict[str, dict[str, Any]]:
        """Stops at the limits of a joint, or an omission."""
        if joint.range is None:
            return {}
        if self.stops is None:
            reason = "the model has no stops; import with --stops STIFFNESS for elastic ones"
            self.omissions.append(Omission(joint.element.place, "limits of joints", reason))
            return {}
        lower, upper = joint.range
        if lower > upper:
            raise joint.element.error(f"the limits are {lower:g} and {upper:g}; exchange them")
        limits = {"lower": lower, "upper": upper, "stiffness": self.stops}
        return {"stop": {"type": "Stop", "coordinate": self.coordinate(joint), **limits}}

    # joints -----------------------------------------------------------------------------------
    def _add_joints(self, link: Link) -> None:
        base = self.kinematics.carrier(link.parent)
        base = Carrier(base.link, base.pose @ link.pose)
        body = "ground" if base.link is None else self.bodies[base.link]
        pose = base.pose
        for k, joint in enumerate(link.joints, 1):
            last = k == len(link.joints)
            child = self.bodies[link] if last else self.between(link, k)
            if joint.kind != FREE:
                name = self.joints[joint]
                at = Pose(joint.anchor, axes_about(joint.axis))
                if joint.kind == BALL:
                    at = Pose(joint.anchor)
                ends = [self.add_frame(body, name, pose @ at), self.add_frame(child, name, at)]
                self.sections["joints"][name] = {"type": TYPES[joint.kind], "connect": ends}
                if comment := _comment(joint):
                    self.comments[f"joints.{name}"] = comment
            elif joint.damping:
                self._add_forces(child, free_damper(joint, child))
            body, pose = child, Pose()

    def _add_closure(self, closure: Closure) -> None:
        name = self.names.add(closure.name, "joint")
        carriers = [
            Carrier(base.link, base.pose @ pose)
            for link, pose in zip(closure.links, closure.poses, strict=True)
            for base in [self.kinematics.carrier(link)]
        ]
        if carriers[0].link is carriers[1].link:
            raise closure.element.error(
                "connects two links that are rigidly connected anyway; remove it"
            )
        ends = [self.frame(carrier, name) for carrier in carriers]
        self.sections["joints"][name] = {"type": closure.type, "connect": ends, **closure.keys}
        if closure.motion is not None:
            self.joints[closure.motion] = name
            if comment := _comment(closure.motion):
                self.comments[f"joints.{name}"] = comment

    def _add_dependence(self, dependence: Dependence) -> None:
        """A coupling of a fixed ratio, or a formula."""
        first, second = dependence.first, dependence.second
        name = self.names.add(dependence.name, "coupling")
        coefficients = dependence.coefficients
        if first is not None and not any(coefficients[2:]):
            joints = {"joint_i": self.joints[first], "joint_j": self.joints[second]}
            ratio = coefficients[1] if len(coefficients) > 1 else 0.0
            self.sections["joints"][name] = {"type": "Coupling", **joints, "ratio": ratio}
            return
        terms = [number_text(coefficients[0])]
        if first is not None:
            x = self.coordinate(first)
            powers = [x, *(f"{x}**{k}" for k in range(2, len(coefficients)))]
            pairs = zip(coefficients[1:], powers, strict=True)
            terms += [f"{number_text(c)}*{power}" for c, power in pairs if c]
        formula = f"{self.coordinate(second)} - ({' + '.join(terms)})"
        self.sections["joints"][name] = {
            "type": "UserConstraint",
            "formula": formula,
            "unit": UNITS[second.kind],
        }

    def _add_actuator(self, actuator: Actuator) -> None:
        """An input, and a force along each joint of the actuator, or at its site."""
        control = self.names.add(actuator.name, "input")
        low, high = actuator.bounds or (0.0, 0.0)
        table: dict[str, Any] = {"value": min(max(low, 0.0), high)}
        if actuator.bounds is not None:
            table["bounds"] = [low, high]
        self.sections["inputs"][control] = table
        coordinates = [self.coordinate(joint) for joint, _ in actuator.joints]
        activation = self._activation(actuator, control)
        formula = actuator_formula(actuator, activation, coordinates)
        if actuator.site is not None:
            self._add_wrench(control, formula, actuator.site, actuator.wrench)
        for joint, coefficient in actuator.joints:
            name = self.names.add(f"{control}_force")
            value = scaled(coefficient, formula)
            self.sections["forces"][name] = {
                "type": "JointActuator",
                "joint": self.joints[joint],
                "value": value,
            }
            self.efforts.setdefault(joint, []).append(name)

    def _activation(self, actuator: Actuator, control: str) -> str:
        """The control, or the output of a block that filters or integrates it."""
        if not actuator.activation:
            return control
        name = self.names.add(f"{control}_activation")
        if actuator.activation == "filter":
            cutoff = 1 / actuator.time_constant
            self.sections["blocks"][name] = {"type": "LowPass", "input": control, "cutoff": cutoff}
            return f"{name}.output"
        self.sections["blocks"][name] = {"type": "State", "rate": control}
        return f"{name}.value"

    def _add_wrench(
        self, control: str, formula: str, site: tuple[Link, Pose], wrench: np.ndarray
    ) -> None:
        """A force and a moment at a site, in the axes of its body."""
        carrier = self.kinematics.carrier(site[0])
        if carrier.link is None:
            return
        body, pose = self.bodies[carrier.link], carrier.pose @ site[1]
        force, moment = (
            [scaled(c, formula) if c else 0.0 for c in tidy(pose.turned(part))]
            for part in (wrench[:3], wrench[3:])
        )
        if any(force):
            place = {"body": body, "at": tidy(pose.place)}
            table = {"type": "Force", "connect": [place], "vector": force, "follows": body}
            self._add_forces(control, {"force": table})
        if any(moment):
            table = {"type": "Torque", "connect": [body], "vector": moment, "follows": body}
            self._add_forces(control, {"torque": table})

    def _limit_effort(self, joint: Joint, names: list[str]) -> None:
        """Replace the forces of the actuators of a joint by their limited sum."""
        if joint.effort_range is None:
            return
        forces = self.sections["forces"]
        total = sum_of([forces[name]["value"] for name in names])
        forces[names[0]]["value"] = within(total, joint.effort_range)
        for name in names[1:]:
            del forces[name]

    def _add_lift(self, link: Link) -> None:
        """A force at the mass centre of a link against gravity."""
        carrier = self.kinematics.carrier(link)
        if carrier.link is None or not link.lift or self.robot.gravity is None:
            return
        weight = -link.lift * link.inertia.mass * self.robot.gravity
        body = self.bodies[carrier.link]
        place = {"body": body, "at": tidy(carrier.pose.at(link.inertia.center))}
        force = {"type": "Force", "connect": [place], "vector": tidy(weight)}
        self._add_forces(body, {"lift": force})

    def coordinate(self, joint: Joint) -> str:
        """Measure of the coordinate of a joint."""
        return f"{self.joints[joint]}.{COORDINATES[joint.kind]}"


def _comment(joint: Joint) -> str:
    texts = [joint.comment] if joint.comment else []
    if joint.range is not None and joint.kind in UNITS:
        lower, upper = (f"{limit:.6g}" for limit in joint.range)
        texts.append(f"range {lower} to {upper} {UNITS[joint.kind]}")
    return "; ".join(texts)
