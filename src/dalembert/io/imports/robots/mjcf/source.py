"""Elements of an MJCF file with its included files, default classes and compiler options."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from dalembert.errors import FileError
from dalembert.io.imports.robots.pose import (
    Pose,
    axes_to_z,
    axis_angle_axes,
    euler_axes,
    quaternion_axes,
)
from dalembert.io.imports.robots.reader import Omissions
from dalembert.io.imports.xml.element import XmlElement
from dalembert.io.imports.xml.parsing import read_xml
from dalembert.io.imports.xml.resources import Resources

ACTUATORS = (
    *("general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder"),
    *("muscle", "adhesion", "dcmotor", "plugin"),
)
"""Tags of actuators, which share their defaults."""
ORIENTATIONS = frozenset(("quat", "axisangle", "euler", "xyaxes", "zaxis"))
"""Attributes that give an orientation."""
MAIN = "main"
"""Name of the default class of all elements."""


class MjcfSource:
    """The elements of a file.

    Parameters
    ----------
    path : Path
    resources : lookup of included files and meshes
    omissions : for folders that are not read

    Attributes
    ----------
    root : the root element with all included elements
    files : root elements of all files
    """

    def __init__(self, path: Path, resources: Resources, omissions: Omissions):
        self.path, self.resources, self.omissions = path, resources, omissions
        self.root = read_xml(path)
        if self.root.tag != "mujoco":
            raise FileError(
                f"{path}: the root element is <{self.root.tag}>, expected <mujoco>; files of other "
                "formats have the suffixes .urdf and .sdf"
            )
        self.root.visited = True
        self.included = {path.resolve()}
        self.files = [self.root]
        self._include(self.root)
        self.compilers = self.sections("compiler")
        for compiler in self.compilers:
            compiler.choice("coordinate", ("local",), "local")
        self._defaults: dict[str, list[XmlElement]] = {MAIN: []}
        for element in self.root.all("default"):
            self._read_default(element, MAIN)

    def sections(self, tag: str) -> list[XmlElement]:
        """All top sections with a tag."""
        return self.root.all(tag)

    def _include(self, element: XmlElement) -> None:
        """Replace the includes in an element by the elements of their files."""
        position = 0
        while position < len(element.children):
            child = element.children[position]
            if child.tag != "include":
                self._include(child)
                position += 1
                continue
            child.visited = True
            try:
                file = self.resources.find(child.text("file"))
            except FileError as error:
                raise child.error(str(error)) from None
            if file in self.included:
                raise child.error(f"{file.name} is included a second time; include it once")
            self.included.add(file)
            content = read_xml(file)
            content.visited = True
            content.ignore(*content.attributes)
            for grandchild in content.children:
                grandchild.parent = element
            element.children[position : position + 1] = content.children

    # compiler options -------------------------------------------------------------------------
    def option(self, name: str, default: str) -> str:
        """An option of the compiler; the last one applies."""
        values = [v for c in self.compilers if (v := c.optional(name)) is not None]
        return values[-1] if values else default

    def is_on(self, name: str, default: bool) -> bool:
        """A switch of the compiler."""
        values = [c.flag(name, default) for c in self.compilers if c.has(name)]
        return values[-1] if values else default

    def bound(self, name: str, default: float) -> float:
        """A number of the compiler."""
        values = [c.number(name) for c in self.compilers if c.has(name)]
        return values[-1] if values else default

    @property
    def degree(self) -> float:
        """Unit of angles in the file [rad]."""
        return 1.0 if self.option("angle", "degree") == "radian" else math.pi / 180

    def limits(
        self, element: XmlElement, range_name: str, limited_name: str
    ) -> tuple[float, float] | None:
        """Lower and upper limit of an attribute such as ``range``, if it applies.

        It does if ``limited`` is true, or automatic, which is the default, with ``autolimits``.
        """
        limited = element.text(limited_name, "auto").lower()
        if not element.has(range_name) or limited in ("false", "0"):
            if limited in ("true", "1"):
                raise element.error(f"{limited_name} is true; give {range_name}, too")
            element.ignore(range_name)
            return None
        if limited == "auto" and not self.is_on("autolimits", True):
            reason = f"autolimits is off; write {limited_name}"
            self.omissions.add(element, f"{element.tag} {range_name}", reason)
            element.ignore(range_name)
            return None
        lower, upper = element.numbers(range_name, 2)
        return lower, upper

    # default classes --------------------------------------------------------------------------
    def _read_default(self, element: XmlElement, parent: str) -> None:
        name = element.text("class", MAIN if parent == MAIN else None)
        if name not in self._defaults:
            self._defaults[name] = [*self._defaults[parent]]
        for child in element.children:
            child.visited = True
            if child.tag != "default":
                self._defaults[name].insert(0, child)
        for child in element.all("default"):
            self._read_default(child, name)

    def with_defaults(self, element: XmlElement, inherited: str | None) -> XmlElement:
        """The element with the attributes of its default class."""
        name = element.optional("class") or inherited or MAIN
        if name not in self._defaults:
            known = ", ".join(self._defaults)
            raise element.error(f"there is no default class {name!r}; defined are: {known}")
        tags = ACTUATORS if element.tag in ACTUATORS else (element.tag,)
        element.defaults = [d for d in self._defaults[name] if d.tag in tags]
        element.visited = True
        return element

    # poses ------------------------------------------------------------------------------------
    def pose(self, element: XmlElement) -> Pose:
        """Pose of an element by ``pos`` and one of the orientations."""
        place = np.array(element.numbers("pos", 3, default=(0.0, 0.0, 0.0)))
        return Pose(place, self.axes(element))

    def axes(self, element: XmlElement) -> np.ndarray:
        """Orientation of an element; its own one replaces those of its defaults in any notation."""
        element.ignore(*ORIENTATIONS)
        elements = (element, *element.defaults)
        owner = next((e for e in elements if e.attributes.keys() & ORIENTATIONS), element)
        notations = [name for name in owner.attributes if name in ORIENTATIONS]
        if len(notations) > 1:
            raise owner.error(f"has {' and '.join(notations)}; keep one orientation")
        return self._orientation(owner, notations[0]) if notations else np.eye(3)

    def _orientation(self, element: XmlElement, notation: str) -> np.ndarray:
        """Orientation in one of the notations of the format."""
        if notation == "quat":
            quaternion = element.numbers("quat", 4)
            if not any(quaternion):
                raise element.error("quat is zero; a unit quaternion has the norm 1")
            return np.eye(3) if quaternion[1:] == [0.0] * 3 else quaternion_axes(quaternion)
        if notation == "axisangle":
            *axis, angle = element.numbers("axisangle", 4)
            self._need_direction(element, "axisangle", axis)
            return axis_angle_axes(axis, angle * self.degree)
        if notation == "euler":
            return self.euler(element.numbers("euler", 3))
        if notation == "xyaxes":
            numbers = np.array(element.numbers("xyaxes", 6))
            x = numbers[:3] / self._need_direction(element, "xyaxes", numbers[:3])
            y = numbers[3:] - (numbers[3:] @ x) * x
            y /= self._need_direction(element, "xyaxes", y)
            return np.column_stack([x, y, np.cross(x, y)])
        z = np.array(element.numbers("zaxis", 3))
        self._need_direction(element, "zaxis", z)
        return axes_to_z(z)

    def euler(self, angles: Sequence[float]) -> np.ndarray:
        """Successive rotations in the sequence and the unit of the file."""
        sequence = self.option("eulerseq", "xyz")
        if len(sequence) != 3 or set(sequence.lower()) - set("xyz"):
            raise self.compilers[-1].error(f"eulerseq is {sequence!r}, expected such as xyz")
        return euler_axes(sequence, [angle * self.degree for angle in angles])

    def _need_direction(
        self, element: XmlElement, name: str, vector: np.ndarray | list[float]
    ) -> float:
        length = float(np.linalg.norm(vector))
        if not length > 0:
            raise element.error(f"{name} has no direction; give a vector that is not zero")
        return length

    def mesh_file(self, element: XmlElement) -> Path:
        """The file of a mesh.

        Raises
        ------
        FileError
            Missing, or outside the permitted folders.
        """
        name = element.text("file")
        if self.is_on("strippath", False):
            name = Path(name.replace("\\", "/")).name
        folder = self.option("meshdir", self.option("assetdir", ""))
        return self.resources.find(name, self.path.resolve().parent / folder)
