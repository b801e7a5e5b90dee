"""Meshes in the binary format of MuJoCo, ``.msh``.

Four counts of 4 bytes (vertices, normals, texture coordinates, faces), then 3, 3 and 2 numbers of
single precision for each of the first three, and 3 indices of vertices for each face.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dalembert.errors import FileError
from dalembert.files import readable

WEIGHT = 40
"""Memory per byte of a file while it is read [bytes]."""
HEADER = 16
"""Length of the counts [bytes]."""


def read_binary_mesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) corners and (m, 3) triangles in a file.

    Raises
    ------
    FileError
        Unreadable, or its length differs from the one that its counts require.
    """
    data = path.read_bytes()[: readable(path, WEIGHT)]
    if len(data) < HEADER:
        raise FileError(f"{path}: has {len(data)} bytes, and no counts; export the mesh again")
    vertices, normals, textures, faces = (int(n) for n in np.frombuffer(data, "<i4", 4))
    size = HEADER + 4 * (3 * vertices + 3 * normals + 2 * textures + 3 * faces)
    if min(vertices, normals, textures, faces) < 0 or size != len(data):
        raise FileError(
            f"{path}: has {len(data)} bytes, expected {size} by its counts; export the mesh again"
        )
    corners = np.frombuffer(data, "<f4", 3 * vertices, HEADER).reshape(-1, 3).astype(float)
    triangles = np.frombuffer(data, "<i4", 3 * faces, size - 12 * faces).reshape(-1, 3)
    if not np.isfinite(corners).all() or (triangles < 0).any() or (triangles >= vertices).any():
        raise FileError(f"{path}: has corners or indices that do not exist; export the mesh again")
    return corners, triangles.astype(int)
