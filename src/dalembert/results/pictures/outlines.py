"""Outlines of shapes for Matplotlib, in the body frame; NaN rows separate lines."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

ANGLES = np.linspace(0, 2 * np.pi, 49)
CIRCLE = np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])
SMOOTH = 0.94
"""Threshold of the cosine between normals of adjacent triangles for drawing their edge."""
FLAT = 1 - 1e-12
"""Cosine of the angle of two faces in one plane."""
MAX_EDGES = 150
"""Upper limit of edges drawn for a smooth surface."""
Shape = dict[str, Any]


def outline(shape: Shape) -> np.ndarray:
    """(n, 2) or (n, 3) points."""
    kind = shape["kind"]
    if kind in ("bar", "line", "capsule"):
        return np.array([shape["from"], shape["to"]])
    if kind == "curve":
        points = np.array(shape["points"])
        return closed(points) if shape["closed"] else points
    if kind == "polygon":
        return closed(np.array(shape["points"]))
    return SPATIAL[kind](shape) if _spatial(shape) else PLANAR[kind](shape)


def _spatial(shape: Shape) -> bool:
    return len(shape.get("center", (0, 0, 0))) == 3


def closed(points: np.ndarray) -> np.ndarray:
    """Points closed by the first point."""
    return np.vstack([points, points[:1]])


def joined(*lines: np.ndarray) -> np.ndarray:
    """Several lines joined to one, with gaps."""
    gap = np.full((1, lines[0].shape[1]), np.nan)
    return np.vstack([row for line in lines for row in (line, gap)][:-1])


# in the plane ----------------------------------------------------------------------------------
def _wheel(shape: Shape) -> np.ndarray:
    center = np.array(shape["center"])
    return closed(np.vstack([center, center + shape["radius"] * CIRCLE]))


def _block(shape: Shape) -> np.ndarray:
    c, s = np.cos(shape["angle"]), np.sin(shape["angle"])
    half = np.array([shape["width"], shape["height"]]) / 2
    corners = half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    return closed(np.array(shape["center"]) + corners @ np.array([[c, s], [-s, c]]))


def _dot(shape: Shape) -> np.ndarray:
    return np.array(shape["center"]).reshape(1, -1)


PLANAR = {"disc": _wheel, "block": _block, "particle": _dot}


# in space --------------------------------------------------------------------------------------
def _across(axis: np.ndarray) -> np.ndarray:
    """(3, 2) two directions normal to an axis."""
    return np.linalg.svd(axis.reshape(1, 3))[2][1:].T


def _rings(ends: list[np.ndarray], radius: float) -> np.ndarray:
    """Circles about a line at its ends, joined by four lines."""
    rim = radius * CIRCLE @ _across(ends[1] - ends[0]).T
    sides = [np.array([end + rim[k] for end in ends]) for k in (0, 12, 24, 36)]
    return joined(*(end + rim for end in ends), *sides)


def _drum(shape: Shape) -> np.ndarray:
    return _rings([np.array(shape["from"]), np.array(shape["to"])], shape["radius"])


def _disc(shape: Shape) -> np.ndarray:
    axis, center = np.array(shape["axis"]), np.array(shape["center"])
    rim = center + shape["radius"] * CIRCLE @ _across(axis).T
    return joined(rim, rim[[0, 24]], rim[[12, 36]])


def _ellipsoid(shape: Shape) -> np.ndarray:
    size = np.array(shape.get("size", [2 * shape.get("radius", 0.0)] * 3)) / 2
    rings = [np.insert(CIRCLE, k, 0.0, axis=1) * size for k in range(3)]
    return _transformed(joined(*rings), shape)


def _box(shape: Shape) -> np.ndarray:
    corners = np.array(list(product((-0.5, 0.5), repeat=3))) * shape["size"]
    edges = [corners[[i, i + s]] for s in (1, 2, 4) for i in range(8) if not i & s]
    return _transformed(joined(*edges), shape)


def _transformed(points: np.ndarray, shape: Shape) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    rotation = Rotation.from_quat(shape.get("turn", (1, 0, 0, 0)), scalar_first=True)
    return points @ rotation.as_matrix().T + shape["center"]


def _plate(shape: Shape) -> np.ndarray:
    from scipy.spatial import ConvexHull

    points = np.array(shape["points"])
    flat = points @ np.linalg.svd(points - points.mean(axis=0))[2][:2].T
    return closed(points[ConvexHull(flat).vertices])


def _surface(shape: Shape) -> np.ndarray:
    """Sharp edges and the border of a surface; a sample of all edges if it has none."""
    positions = np.reshape(shape["vertices"], (-1, 3))
    faces = np.reshape(shape["faces"], (-1, 3)).astype(int)  # of pages, numbers with fractions
    normals = np.cross(
        positions[faces[:, 1]] - positions[faces[:, 0]],
        positions[faces[:, 2]] - positions[faces[:, 0]],
    )
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    sides = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, edge, counts = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    owners = np.repeat(np.arange(len(faces)), 3)[np.argsort(edge.ravel(), kind="stable")]
    last = np.cumsum(counts) - 1
    cosines = np.einsum("ij,ij->i", normals[owners[last]], normals[owners[last - 1]])
    border, sharp = counts == 1, (counts > 1) & (cosines < SMOOTH)
    if not sharp.any():
        curved = np.flatnonzero(~border & (cosines < FLAT))
        sharp[curved[:: max(1, len(curved) // MAX_EDGES)]] = True
    chosen = edges[border | sharp]
    return joined(*positions[chosen])


SPATIAL = {
    "particle": _dot,
    "sphere": _ellipsoid,
    "ellipsoid": _ellipsoid,
    "box": _box,
    "cylinder": _drum,
    "disc": _disc,
    "block": _dot,
    "plate": _plate,
    "mesh": _surface,
}
