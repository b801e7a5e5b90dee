"""Geometry of a body for pictures, without mass and without contacts."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Look
from dalembert.elements.body import BodyElement
from dalembert.elements.frame import Frame
from dalembert.elements.point import Point
from dalembert.elements.spatial.look import Cuboid, Drum, Orb, Pill, Surface
from dalembert.elements.spatial.surface import read_triangles
from dalembert.errors import DalembertError, ModelError
from dalembert.text.arguments import CheckedArguments
from dalembert.text.wording import unknown

SIZES = {
    "Box": ("size",),
    "Ellipsoid": ("size",),
    "Sphere": ("radius",),
    "Cylinder": ("radius", "length"),
    "Capsule": ("radius", "length"),
    "Mesh": ("file",),
}
"""Type → its sizes."""
MAX_TRIANGLES = 4000
"""Threshold above which a mesh is drawn coarser."""
CELLS = 24
"""Number of cells along a coarser mesh."""
ROUND = 16
"""Number of corners around an ellipsoid."""
BOX = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
BOX_FACES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ]
)


@dataclass(frozen=True)
class Geometry(CheckedArguments):
    """A solid that pictures show instead of the ellipsoid of the inertia.

    Cylinders and capsules are about the z axis of the solid.

    Parameters
    ----------
    type : ``"Box"``, ``"Sphere"``, ``"Ellipsoid"``, ``"Cylinder"``, ``"Capsule"`` or ``"Mesh"``
    at : (3,) its centre, or the origin of the mesh, in the body frame [m]
    axis, x : (3,) its z and x axes in the body frame
    size : (3,) lengths of a box, diameters of an ellipsoid [m]
    radius, length : of a sphere, cylinder or capsule, between the centres of its ends [m]
    file : STL, OBJ, PLY or glTF file of a mesh, read with trimesh
    scale : length of the unit of the file, for each axis [m]

    Raises
    ------
    ModelError
        An unknown type, or another set of sizes.

    Examples
    --------
    >>> from dalembert import spatial
    >>> rim = spatial.Geometry("Cylinder", radius=0.3, length=0.2, axis=(0, 1, 0))
    >>> wheel = spatial.Body("wheel", mass=9.0, inertia=(0.3, 0.5, 0.3), geometry=[rim])
    >>> [type(look).__name__ for look in wheel.look()]
    ['Drum']
    """

    type: str
    at: Sequence[float] = (0.0, 0.0, 0.0)
    axis: Sequence[float] | None = None
    x: Sequence[float] | None = None
    size: Sequence[float] | None = None
    radius: float | None = None
    length: float | None = None
    file: str | Path | None = None
    scale: Sequence[float] = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        if self.type not in SIZES:
            raise ModelError(unknown("type", self.type, SIZES), "geometry")
        for name in ("size", "radius", "length", "file"):
            value, needed = getattr(self, name), name in SIZES[self.type]
            if (value is not None) is not needed:
                sizes = " and ".join(SIZES[self.type])
                raise ModelError(f"a {self.type} has {sizes}", f"geometry.{name}")
            if needed and name != "file":
                numbers = np.atleast_1d(np.asarray(value, dtype=float))
                count = 3 if name == "size" else 1
                if numbers.shape != (count,) or not (numbers > 0).all():
                    message = f"expected {count} positive number(s), got {value!r}"
                    raise ModelError(message, f"geometry.{name}")

    def look(self, body: BodyElement) -> list[Look]:
        """Primitives attached to a body."""
        axes = np.array(ca.DM(Frame(body, self.at, axis=self.axis, x=self.x).local_axes))
        radius = ca.SX(self.radius or 0.0)
        if self.type == "Sphere":
            return [Orb(Point(body, self.at), radius)]
        if self.type == "Box" and self.axis is None:
            return [Cuboid(Point(body, self.at), ca.SX(list(self.size or ())))]
        if self.type in ("Cylinder", "Capsule"):
            half = axes[:, 2] * (self.length or 0.0) / 2
            low, high = (Point(body, (np.asarray(self.at) + s * half).tolist()) for s in (-1, 1))
            kind = Drum if self.type == "Cylinder" else Pill
            return [kind(low, high, radius)]
        try:
            corners, triangles = self._surface()
        except DalembertError as error:
            warnings.warn(f"{body.name}: its geometry is not drawn: {error}", stacklevel=2)
            return []
        return [Surface(body, np.asarray(self.at) + corners @ axes.T, triangles, ca.SX(1.0))]

    def _surface(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners in the axes of the solid, and triangles."""
        if self.type == "Box":
            return BOX * np.asarray(self.size), BOX_FACES
        if self.type == "Ellipsoid":
            corners, triangles = _ball()
            return corners * np.asarray(self.size) / 2, triangles
        corners, triangles = read_triangles(Path(str(self.file)), "geometry.file")
        if not len(triangles) or not np.isfinite(corners).all():
            raise ModelError(f"{self.file} has no triangles with finite corners", "geometry.file")
        if len(triangles) > MAX_TRIANGLES:
            corners, triangles = _coarser(corners, triangles)
        corners = corners * np.asarray(self.scale)
        mirrored = np.prod(self.scale) < 0
        return corners, triangles[:, ::-1] if mirrored else triangles


def _ball() -> tuple[np.ndarray, np.ndarray]:
    """Corners and triangles of a ball of radius 1."""
    rows = ROUND // 2 + 1
    tilt, turn = np.meshgrid(
        np.linspace(0, math.pi, rows), np.arange(ROUND) * 2 * math.pi / ROUND, indexing="ij"
    )
    corners = np.stack(
        [np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)], axis=-1
    )
    index = np.arange(rows * ROUND).reshape(rows, ROUND)
    a, b = index[:-1], index[1:]
    c, d = np.roll(b, -1, axis=1), np.roll(a, -1, axis=1)
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
    return corners.reshape(-1, 3), triangles.reshape(-1, 3)


def _coarser(corners: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A mesh whose corners in the same cell of a grid are one."""
    low, extent = corners.min(axis=0), float(np.ptp(corners, axis=0).max())
    cells = np.floor((corners - low) * CELLS / extent).astype(np.int64)
    _, of_corner, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    of_corner = of_corner.ravel()
    merged = np.zeros((len(counts), 3))
    np.add.at(merged, of_corner, corners)
    faces: Any = of_corner[triangles]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (a != c)]
    return merged / counts[:, None], np.unique(faces, axis=0)
