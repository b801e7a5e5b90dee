"""Separate parts of a closed surface: solids beside each other, and cavities in solids."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dalembert.errors import ModelError

SAMPLES = 200
"""Upper limit of the places of a part that are tested."""
INWARD = 1e-5
"""Distance of these places from their triangles, by the size of the surface."""
BLOCK = 1_000_000
"""Number of pairs of places and triangles that are computed together."""


def refuse_misplaced_parts(
    corners: np.ndarray, triangles: np.ndarray, path: Path, entity: str
) -> None:
    """Check the parts of a closed surface whose volume is positive.

    Outward parts lie outside of the material of the others, inward ones are cavities in it. The
    winding number of the other parts is 0 or 1 there.

    Parameters
    ----------
    corners : (n, 3)
    triangles : (m, 3)

    Raises
    ------
    ModelError
        Solids overlap, or a part outside of the others has inward normals.
    """
    part = _parts(corners, triangles)
    if part.max(initial=0) == 0:
        return
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    areas, size = np.cross(b - a, c - a), np.ptp(corners, axis=0).max()
    length = np.linalg.norm(areas, axis=1, keepdims=True)
    inside = (a + b + c) / 3 - INWARD * size * areas / np.where(length > 0, length, 1.0)
    volumes = np.bincount(part, np.linalg.det(np.stack([a, b, c], axis=1) - corners.mean(axis=0)))
    for k, volume in enumerate(volumes):
        own = np.flatnonzero((part == k) & (length[:, 0] > 0))
        places = inside[own[:: -(-own.size // SAMPLES)]]
        winding = _winding(places, np.stack([a, b, c], axis=1)[part != k])
        where = ", ".join(f"{x:.4g}" for x in corners[triangles[part == k]].mean(axis=(0, 1)))
        if volume < 0 and (winding < 0.5).any():
            raise ModelError(
                f"{path} has a part about ({where}) with inward normals that is no cavity of "
                "another part; turn its normals in its CAD program",
                entity,
            )
        if volume > 0 and (winding > 0.5).any():
            raise ModelError(
                f"{path} has a part about ({where}) that overlaps another part, so that their "
                "common volume counts twice; join them in its CAD program, or turn the normals of "
                "a cavity inward",
                entity,
            )


def _parts(corners: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(m,) numbers of the parts of triangles, which are connected by corners."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ends = triangles[:, [0, 1]].T, triangles[:, [1, 2]].T
    i, j = np.hstack(ends)
    count = len(corners)
    graph = coo_array((np.ones(i.size), (i, j)), shape=(count, count))
    label = connected_components(graph, directed=False)[1]
    return np.unique(label[triangles[:, 0]], return_inverse=True)[1]


def _winding(places: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(k,) winding numbers of triangles (m, 3, 3) about places (k, 3), by their solid angles (Van
    Oosterom & Strackee 1983)."""
    winding, rows = np.zeros(len(places)), max(1, BLOCK // max(len(triangles), 1))
    for start in range(0, len(places), rows):
        a, b, c = np.moveaxis(triangles[None] - places[start : start + rows, None, None], 2, 0)
        x, y, z = (np.linalg.norm(vector, axis=2) for vector in (a, b, c))
        volume = (a * np.cross(b, c)).sum(axis=2)
        cosine = x * y * z + (a * b).sum(axis=2) * z + (b * c).sum(axis=2) * x
        cosine += (c * a).sum(axis=2) * y
        winding[start : start + rows] = np.arctan2(volume, cosine).sum(axis=1) / (2 * np.pi)
    return winding
