"""Common parts of the readers of URDF, MJCF and SDF."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from dalembert.io.imports.imported import Imported
from dalembert.io.imports.robots.document import RobotDocument
from dalembert.io.imports.robots.parts import Robot, Shape
from dalembert.io.imports.robots.pose import Pose
from dalembert.io.imports.xml.element import XmlElement
from dalembert.io.omission import Omission

DRAWN = (".stl", ".obj", ".ply", ".gltf", ".glb")
"""Suffixes of meshes that can be drawn."""
UNKNOWN = "has no equivalent in a model file"


class Omissions:
    """Collection of what is not converted.

    Parameters
    ----------
    reasons : tag or attribute, or ``tag.attribute`` → reason
    """

    def __init__(self, reasons: Mapping[str, str]):
        self.reasons = reasons
        self.entries: list[Omission] = []

    def add(self, element: XmlElement, content: str, reason: str) -> None:
        self.entries.append(Omission(element.place, content, reason))

    def add_file(self, element: XmlElement, content: str, reference: str, error: Exception) -> None:
        """A file that cannot be read; the reason is the same for all files of a kind."""
        self.add(element, content, str(error).removeprefix(f"{reference}: "))

    def add_unread(self, root: XmlElement) -> None:
        """All elements and attributes of a file that were not read."""
        for element, name in root.unread():
            if name:
                keys = (f"{element.tag}.{name}", name)
                content = f"{element.tag} {name}"
            else:
                parent = element.parent.tag if element.parent is not None else ""
                keys = (f"{parent}/{element.tag}", element.tag)
                content = f"<{element.tag}>"
            reason = next((self.reasons[k] for k in keys if k in self.reasons), UNKNOWN)
            self.add(element, content, reason)


def mesh_shape(
    file: Path, scale: Sequence[float], pose: Pose, element: XmlElement, omissions: Omissions
) -> Shape | None:
    """A mesh for pictures; listed among the omissions if its format cannot be drawn."""
    if file.suffix.lower() not in DRAWN:
        formats = ", ".join(DRAWN)
        reason = f"{file.suffix} cannot be drawn; convert it to one of {formats}"
        omissions.add(element, "mesh", reason)
        return None
    factors = [*scale] if len(scale) == 3 else [*scale] * 3
    sizes = {"file": file} | ({} if factors == [1.0] * 3 else {"scale": factors})
    return Shape("Mesh", pose, sizes)


def imported_robot(
    path: Path,
    kind: str,
    robot: Robot,
    omissions: Omissions,
    roots: Sequence[XmlElement],
    stops: float | None = None,
    repair_inertia: bool = False,
) -> Imported:
    """The model file of a robot, with everything that was not read among the omissions.

    Raises
    ------
    ModelError
        Nothing moves, or an impossible inertia.
    """
    if not any(link.joints for link in robot.links):
        cure = "; import it with --base free if it floats" if kind == "URDF" else ""
        unread = [element for root in roots for element, name in root.unread() if not name]
        tags = ", ".join(dict.fromkeys(element.label for element in unread[:5]))
        cure += f"; not converted: {tags}" if tags and kind == "MJCF" else ""
        raise roots[0].error(f"has no joint, so that nothing moves{cure}")
    writer = RobotDocument(robot, stops, repair_inertia)
    for root in roots:
        omissions.add_unread(root)
    entries = [*omissions.entries, *writer.omissions]
    heading = f"{robot.name}: imported from {path.name} ({kind})."
    if entries:
        contents = dict.fromkeys(omission.content for omission in entries)
        heading += f"\nNot converted: {', '.join(contents)}."
    names = {joint.name: name for joint, name in writer.joints.items()}
    return Imported(path, writer.document, entries, {"": heading, **writer.comments}, names)
