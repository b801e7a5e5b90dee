"""Closed surfaces of triangles, read from files of CAD programs, and what they enclose."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import ModelError, UnsupportedError
from dalembert.files import readable

WEIGHT = 200
"""Bytes of memory that a byte of a file takes while it is read."""
FORMATS = "STL, OBJ, PLY or glTF"
FLAT = 1e-12
"""Volume relative to the cube of the extent that is none."""


@dataclass(frozen=True)
class SurfaceMesh:
    """Triangles whose normals point outwards.

    Attributes
    ----------
    corners : (n, 3) [m]
    triangles : (m, 3) numbers of corners
    """

    corners: np.ndarray
    triangles: np.ndarray

    def tetrahedra(self) -> tuple[np.ndarray, np.ndarray]:
        """(m, 3, 3) corners of every triangle, from the middle of all; volumes, signed, below."""
        corners = (self.corners - self.corners.mean(axis=0))[self.triangles]
        return corners, np.linalg.det(corners) / 6

    @property
    def volume(self) -> float:
        """Negative where the normals point inwards."""
        return float(self.tetrahedra()[1].sum())

    def enclosed(self) -> tuple[float, np.ndarray, np.ndarray]:
        """Volume, its centre, and ``∫ s sᵀ dV`` (3, 3) about the centre; exact for polyhedra."""
        corners, volumes = self.tetrahedra()
        sums, volume = corners.sum(axis=1), volumes.sum()
        center = volumes @ sums / (4 * volume)
        second = np.einsum("i,inj,ink->jk", volumes, corners, corners)
        second = (second + np.einsum("i,ij,ik->jk", volumes, sums, sums)) / 20
        middle = self.corners.mean(axis=0)
        return volume, middle + center, second - volume * np.outer(center, center)


def read_surface(path: Path, entity: str) -> SurfaceMesh:
    """The closed surface in a file.

    Raises
    ------
    FileError
        There is none, or it is too large.
    ModelError
        Unreadable, open, or it encloses nothing.
    UnsupportedError
        trimesh is not installed.
    """
    corners, triangles = _read(path, entity)
    if not len(triangles) or not np.isfinite(corners).all():
        raise ModelError(f"{path} has no triangles with finite corners; give {FORMATS}", entity)
    refuse_open(triangles, path, entity)
    found = SurfaceMesh(corners, triangles)
    if not abs(found.volume) > FLAT * np.ptp(corners, axis=0).max() ** 3:
        raise ModelError(f"{path} encloses no volume; give {FORMATS} of a solid", entity)
    return found if found.volume > 0 else SurfaceMesh(corners, triangles[:, ::-1])


def _read(path: Path, entity: str) -> tuple[np.ndarray, np.ndarray]:
    try:
        import trimesh
    except ImportError:
        raise UnsupportedError(
            f"{entity}: {path}: solids are read with trimesh, which is not installed; "
            "pip install dalembert[mesh]"
        ) from None
    readable(path, WEIGHT)
    try:
        mesh: Any = trimesh.load(path, force="mesh")
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        return np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces)
    except Exception as error:  # readers of many formats, each with errors of its own
        reason = (str(error) or type(error).__name__).partition("\n")[0][:200]
        raise ModelError(f"{path} cannot be read as {FORMATS} ({reason})", entity) from None


def refuse_open(triangles: np.ndarray, path: Path, entity: str) -> None:
    """Every edge of a closed surface is passed as often there as back.

    Raises
    ------
    ModelError
        Some are not.
    """
    edges = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64)
    there, back = edges @ [edges.max() + 1, 1], edges @ [1, edges.max() + 1]
    _, which = np.unique(np.concatenate([there, back]), return_inverse=True)
    passed = np.bincount(which, np.repeat([1, -1], len(edges)))
    wrong = np.count_nonzero(passed) // 2
    if wrong:
        raise ModelError(
            f"{path} is no closed surface: {wrong} edges have a triangle on one side only, or two "
            "whose normals disagree; close it where it was made, or give mass, inertia and "
            "center_of_mass to a spatial.Body",
            entity,
        )
