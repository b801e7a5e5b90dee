"""Bodies of a model file, with their frames, from the links of a robot."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.io.imports.robots.inertia import (
    NOTHING,
    Inertia,
    combined,
    repaired,
    violation,
)
from dalembert.io.imports.robots.kinematics import Carrier, Kinematics
from dalembert.io.imports.robots.names import Names
from dalembert.io.imports.robots.parts import Link, Robot, Shape
from dalembert.io.imports.robots.pose import Pose, frame_table, rotation_table, tidy
from dalembert.io.omission import Omission

PHYSICAL = 1e-9
"""Tolerance of the inequality of moments of inertia, relative to the largest one."""


class BodyTables:
    """Writer of the bodies of a model file.

    Parameters
    ----------
    robot : Robot
    repair_inertia : whether inertias that no body has are raised, instead of refused

    Attributes
    ----------
    sections : sections of the file, ``ground`` the one of the ground
    comments : key → comment
    omissions : parts without an equivalent
    bodies : link → name in the model file
    """

    def __init__(self, robot: Robot, repair_inertia: bool):
        self.robot, self.repair_inertia = robot, repair_inertia
        self.names = Names.of_parts()
        self.comments: dict[str, str] = {}
        self.omissions: list[Omission] = []
        self.kinematics = Kinematics(robot)
        self.bodies = {link: self.names.add(link.name) for link in robot.links if link.joints}
        self._frames: dict[str, Names] = {}
        self._massless: dict[tuple[Link, int], str] = {}
        self.ground: dict[str, dict[str, Any]] = {}
        self.sections: dict[str, dict[str, Any]] = {
            section: {} for section in ("inputs", "blocks", "bodies", "joints", "forces")
        }

    def add_body(self, link: Link) -> None:
        """A body, after the massless ones between its joints."""
        carried = self.kinematics.fixed_to(link)
        inertia = self._checked(combined(o.inertia.seen_from(pose) for o, pose in carried), carried)
        name = self.bodies[link]
        body: dict[str, Any] = {}
        if inertia.mass or inertia.tensor.any():
            body["mass"] = inertia.mass
            if inertia.center.any():
                body["center_of_mass"] = tidy(inertia.center)
            body["inertia"] = inertia.moments
        *starts, start = self.kinematics.starts(link)
        body |= _start(start)
        shapes = [self._shape(shape, pose) for other, pose in carried for shape in other.shapes]
        if shapes:
            body["geometry"] = shapes
        body["frames"] = {}
        for k, pose in enumerate(starts, 1):
            between = self.between(link, k)
            self.sections["bodies"][between] = {**_start(pose), "frames": {}}
            self.comments[f"bodies.{between}"] = f"massless, between two joints of {name}"
        self.sections["bodies"][name] = body
        welded = [other.name for other, _ in carried[1:]]
        if welded:
            self.comments[f"bodies.{name}"] = f"with {', '.join(welded)}"

    def between(self, link: Link, k: int) -> str:
        """Name of the massless body behind joint k − 1 of a link."""
        key = (link, k)
        if key not in self._massless:
            self._massless[key] = self.names.add(f"{self.bodies[link]}_{k}")
        return self._massless[key]

    def _checked(self, inertia: Inertia, carried: list[tuple[Link, Pose]]) -> Inertia:
        """The inertia, which a body can have."""
        if np.abs(inertia.tensor).max() <= NOTHING:
            return Inertia(inertia.mass, inertia.center)
        if violation(inertia.tensor) <= PHYSICAL:
            return inertia
        links = [link for link, _ in carried if link.inertia.tensor.any()]
        link = max(links, key=lambda link: violation(link.inertia.tensor))
        moments = ", ".join(f"{m:.6g}" for m in np.linalg.eigvalsh(link.inertia.tensor))
        message = (
            f"no body has the principal moments of inertia {moments} kg m²: none exceeds the sum "
            "of the other two, and none is negative"
        )
        if not self.repair_inertia:
            raise link.element.error(
                f"{message}; correct them, or import with --repair-inertia (in Python "
                "repair_inertia=True), which raises the smaller ones"
            )
        self.omissions.append(Omission(link.element.place, "inertia", f"{message}; raised"))
        return Inertia(inertia.mass, inertia.center, repaired(inertia.tensor))

    def _shape(self, shape: Shape, pose: Pose) -> dict[str, Any]:
        table = {"type": shape.kind, **shape.sizes}
        placed = pose @ shape.pose
        frame = frame_table(placed)
        return table | {key: value for key, value in frame.items() if key != "at" or any(value)}

    # frames -----------------------------------------------------------------------------------
    def frame(self, carrier: Carrier, name: str) -> str:
        """Reference to a new frame of a body or the ground, such as ``"arm.elbow"``."""
        body = "ground" if carrier.link is None else self.bodies[carrier.link]
        return self.add_frame(body, name, carrier.pose)

    def add_frame(self, body: str, name: str, pose: Pose) -> str:
        names = self._frames.setdefault(body, Names.of_frames())
        name = names.add(name)
        owner = self.ground if body == "ground" else self.sections["bodies"][body]
        owner.setdefault("frames", {})[name] = frame_table(pose)
        return f"{body}.{name}"

    def add_fixed(self, link: Link) -> None:
        """Frames of links that are part of another body, and further frames of a link."""
        carrier = self.kinematics.carrier(link)
        if not link.joints:
            self.frame(carrier, link.name)
        for name, pose in link.frames.items():
            self.frame(Carrier(carrier.link, carrier.pose @ pose), name)


def _start(pose: Pose | None) -> dict[str, Any]:
    """Initial position and rotation, if joints do not determine them."""
    if pose is None:
        return {}
    rotation = {} if pose.is_unturned else {"rotation": rotation_table(pose.axes)}
    return {"position": tidy(pose.place), **rotation}
