"""Binary STL files of surfaces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.io.exports.shapes.surfaces import Surface

RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""A triangle."""


def stl_file(surfaces: Sequence[Surface]) -> bytes:
    """Triangles of surfaces with their normals."""
    corners = np.concatenate([surface.vertices[surface.triangles] for surface in surfaces])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    table = np.zeros(len(corners), dtype=RECORD)
    table["normal"] = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
    table["corners"] = corners
    header = b"written by dalembert".ljust(80) + np.uint32(len(corners)).tobytes()
    return header + table.tobytes()
