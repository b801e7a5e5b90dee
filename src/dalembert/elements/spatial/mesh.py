"""Bodies bounded by a triangulated surface."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import casadi as ca
import numpy as np

from dalembert.elements.base import Look, Scalar, option, quantity
from dalembert.elements.spatial.look import Surface
from dalembert.elements.spatial.shape import Shape
from dalembert.elements.spatial.surface import read_surface


@dataclass(eq=False)
class Mesh(Shape):
    """Solid from a CAD file, whose axes are those of the body frame.

    Volume, mass centre and inertia are those of the polyhedron. The file is read with trimesh
    (``pip install dalembert[mesh]``).

    Parameters
    ----------
    file : path of an STL, OBJ, PLY or glTF file
    scale : length of the file's unit [m]: 0.001 for millimetres

    Raises
    ------
    ModelError
        The file is unreadable, or its surface open.
    UnsupportedError
        trimesh is not installed.

    Examples
    --------
    >>> import tempfile, trimesh
    >>> from dalembert import spatial
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     size = trimesh.creation.box((20, 10, 5)).export(f"{folder}/brick.stl")
    ...     brick = spatial.Mesh("brick", file=f"{folder}/brick.stl", scale=0.01, density=2000.0)
    >>> round(float(brick.mass), 6)  # 0.2 by 0.1 by 0.05 m
    2.0
    """

    file: Path = option("STL, OBJ, PLY or glTF file", keyword=True)
    scale: Scalar = quantity("m", "length of the unit of the file", default=1.0, above=0.0)

    def __post_init__(self) -> None:
        self.surface = read_surface(Path(self.file), f"{self.name}.file")
        self._volume, self._center, self._second = self.surface.enclosed()
        super().__post_init__()

    def volume(self) -> ca.SX:
        return self._volume * self.scale.sx**3

    def gyration(self) -> ca.SX:
        inertia = np.trace(self._second) * np.eye(3) - self._second
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = inertia / self._volume
        return ca.SX([xx, yy, zz, xy, yz, xz]) * self.scale.sx**2

    def middle(self) -> ca.SX:
        return ca.SX(self._center) * self.scale.sx

    def look(self) -> list[Look]:
        return [Surface(self, self.surface.corners, self.surface.triangles, self.scale.sx)]
