"""Triangulated surfaces in files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import ModelError
from dalembert.files import readable
from dalembert.packages import optional_package

WEIGHT = 200
"""Memory per byte of a file while it is read [bytes]."""
FORMATS = "STL, OBJ, PLY or glTF"
FLAT = 1e-12
"""Threshold of the volume over the cubed extent below which it is zero [-]."""


@dataclass(frozen=True)
class SurfaceMesh:
    """A surface of triangles with outward normals.

    Attributes
    ----------
    corners : (n, 3) [m]
    triangles : (m, 3) indices of corners
    """

    corners: np.ndarray
    triangles: np.ndarray

    def tetrahedra(self) -> tuple[np.ndarray, np.ndarray]:
        """(m, 3, 3) corners of triangles from the mean of all; (m,) signed volumes below them."""
        corners = (self.corners - self.corners.mean(axis=0))[self.triangles]
        return corners, np.linalg.det(corners) / 6

    @property
    def volume(self) -> float:
        """Enclosed volume, negative for inward normals [m³]."""
        return float(self.tetrahedra()[1].sum())

    def enclosed(self) -> tuple[float, np.ndarray, np.ndarray]:
        """Enclosed volume, its centroid, and ``∫ s sᵀ dV`` (3, 3) about it; exact for polyhedra."""
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
        The file does not exist, or is too large.
    ModelError
        The surface is unreadable, open, encloses no volume, or has parts that overlap or are
        turned inside out.
    UnsupportedError
        trimesh is not installed.
    """
    from dalembert.elements.spatial.surface_parts import refuse_misplaced_parts

    corners, triangles = read_triangles(path, entity)
    if not len(triangles) or not np.isfinite(corners).all():
        raise ModelError(f"{path} has no triangles with finite corners; give {FORMATS}", entity)
    refuse_open(triangles, path, entity)
    surface = SurfaceMesh(corners, triangles)
    if not abs(surface.volume) > FLAT * np.ptp(corners, axis=0).max() ** 3:
        raise ModelError(f"{path} encloses no volume; give {FORMATS} of a solid", entity)
    if surface.volume < 0:
        surface = SurfaceMesh(corners, triangles[:, ::-1])
    refuse_misplaced_parts(surface.corners, surface.triangles, path, entity)
    return surface


def read_triangles(path: Path, entity: str) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) corners and (m, 3) triangles in a file; the surface may be open."""
    trimesh = optional_package("trimesh", f"{entity}: reading {path}")
    readable(path, WEIGHT)
    try:
        mesh: Any = trimesh.load(path, force="mesh")
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        return np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces)
    except Exception as error:  # readers of many formats with various errors
        reason = (str(error) or type(error).__name__).partition("\n")[0][:200]
        raise ModelError(f"{path} cannot be read as {FORMATS} ({reason})", entity) from None


def refuse_open(triangles: np.ndarray, path: Path, entity: str) -> None:
    """Check that a surface is closed: every edge is traversed equally often in both directions.

    Raises
    ------
    ModelError
        The surface is open.
    """
    edges = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64)
    forward, backward = edges @ [edges.max() + 1, 1], edges @ [1, edges.max() + 1]
    _, edge_index = np.unique(np.concatenate([forward, backward]), return_inverse=True)
    balance = np.bincount(edge_index, np.repeat([1, -1], len(edges)))
    wrong = np.count_nonzero(balance) // 2
    if wrong:
        raise ModelError(
            f"{path} is no closed surface: {wrong} edges have a triangle on one side only, or two "
            "whose normals disagree; close it in its CAD program, or give mass, inertia and "
            "center_of_mass to a spatial.Body",
            entity,
        )
