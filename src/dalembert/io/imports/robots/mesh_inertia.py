"""Volume, mass centre and moments of inertia of triangulated solids."""

from __future__ import annotations

import numpy as np

from dalembert.errors import FileError, UnsupportedError

SMALLEST = 1e-18
"""Threshold of the volume below which there is none [m³]."""


def mesh_inertia(
    vertices: np.ndarray, faces: np.ndarray, kind: str
) -> tuple[float, np.ndarray, np.ndarray]:
    """Volume, mass centre and moments per unit mass about it.

    Tetrahedra between the faces and a point are summed: with signed volumes (``exact``), with
    absolute ones (``legacy``), or of the convex hull (``convex``). For the mass centre the point is
    the mean of the faces, for the moments the mass centre.

    Raises
    ------
    UnsupportedError
        Another kind.
    FileError
        No volume.
    """
    if kind not in ("legacy", "exact", "convex"):
        raise UnsupportedError(f"inertia {kind!r} of a mesh is not converted")
    if kind == "convex" or not len(faces):
        from scipy.spatial import ConvexHull

        hull = ConvexHull(vertices)
        corners = vertices[hull.simplices]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0
        corners[inward] = corners[inward][:, ::-1]
    else:
        corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    areas = np.linalg.norm(normals, axis=1)
    middle = areas @ corners.mean(axis=1) / areas.sum()
    center = middle + _centroid(*_tetrahedra(corners - middle, kind))
    corners, volumes = _tetrahedra(corners - center, kind)
    volume = float(volumes.sum())
    sums = corners.sum(axis=1)
    second = np.einsum("i,inj,ink->jk", volumes, corners, corners)
    second = (second + np.einsum("i,ij,ik->jk", volumes, sums, sums)) / (20 * volume)
    return abs(volume), center, np.trace(second) * np.eye(3) - second


def _tetrahedra(corners: np.ndarray, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Faces, and volumes of the tetrahedra between them and the origin."""
    volumes = np.linalg.det(corners) / 6
    if kind == "legacy":
        volumes = np.abs(volumes)
    if not abs(volumes.sum()) > SMALLEST:
        raise FileError("the mesh has no volume")
    return corners, volumes


def _centroid(corners: np.ndarray, volumes: np.ndarray) -> np.ndarray:
    center: np.ndarray = volumes @ corners.sum(axis=1) / (4 * volumes.sum())
    return center
