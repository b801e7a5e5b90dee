"""Geometry of the lines and faces of drawings of structures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.elements.look import Cells

COIL = np.array([0, 0.2, *np.linspace(0.2, 0.8, 13)[:-1] + 0.025, 0.8, 1])
"""Positions of the turns of a drawn spring along its line."""
SHARP_ANGLE = 0.6
"""Threshold of the angle between two faces for drawing their edge [rad]."""


def turned_tangent(rotation: np.ndarray, chord: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Change of the end tangent of a line by a finite rotation, scaled to the new chord."""
    angle = np.linalg.norm(rotation, axis=1, keepdims=True)
    axis = np.divide(rotation, angle, out=np.zeros_like(rotation), where=angle > 0)
    turned = (
        chord * np.cos(angle)
        + np.cross(axis, chord) * np.sin(angle)
        + axis * np.sum(axis * chord, axis=1, keepdims=True) * (1 - np.cos(angle))
    )
    stretch = np.linalg.norm(after, axis=1) / np.linalg.norm(chord, axis=1)
    return stretch[:, None] * turned - chord


def tilted_tangent(rotation: np.ndarray, chord: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Change of the end tangent of a line by a small rotation, and by the stretch of its chord."""
    stretch = (after - chord) * chord / np.sum(chord**2, axis=1, keepdims=True)
    return np.cross(rotation, chord) + stretch.sum(axis=1, keepdims=True) * chord


def cubic(moved: np.ndarray, slopes: Sequence[np.ndarray], along: np.ndarray) -> np.ndarray:
    """(ne, s, 3) cubic interpolation between displacements (2, ne, 3) with slopes at the ends."""
    s = along[None, :, None]
    first, second = (part[:, None, :] for part in slopes)
    i, j = (end[:, None, :] for end in moved)
    bent = first * s * (1 - s) ** 2 - second * s**2 * (1 - s)
    return i + (j - i) * (3 * s**2 - 2 * s**3) + bent


def between(ends: np.ndarray, along: np.ndarray) -> np.ndarray:
    """(ne, s, 3) linear interpolation between the values (2, ne, 3) of the ends."""
    s = along[None, :, None]
    return ends[0][:, None, :] * (1 - s) + ends[1][:, None, :] * s


def samples(count: int) -> int:
    """Number of points along a curved line, fewer for many lines."""
    return 13 if count <= 300 else 7 if count <= 3000 else 3


def lanes(spans: np.ndarray) -> np.ndarray:
    """(ne,) lanes that keep lines on one axis from overlapping, short ones below."""
    lane_of = np.zeros(len(spans), dtype=int)
    occupied: list[list[tuple[float, float]]] = []
    for k in np.argsort(spans[:, 1] - spans[:, 0], kind="stable"):
        low, high = spans[k]
        free = (n for n, lane in enumerate(occupied) if all(b <= low or a >= high for a, b in lane))
        lane_of[k] = next(free, len(occupied))
        if lane_of[k] == len(occupied):
            occupied.append([])
        occupied[lane_of[k]].append((low, high))
    return lane_of


def exposed_faces(faces: list[Cells]) -> list[Cells]:
    """Faces of solids that belong to a single element."""
    if not faces:
        return []
    width = max(shape.vertices.shape[1] for shape in faces)
    keys = [
        np.pad(np.sort(v := shape.vertices), ((0, 0), (0, width - v.shape[1])), constant_values=-1)
        for shape in faces
    ]
    _, inverse, counts = np.unique(
        np.concatenate(keys), axis=0, return_inverse=True, return_counts=True
    )
    single = counts[inverse.ravel()] == 1
    exposed, first = [], 0
    for shape in faces:
        mask = single[first : first + len(shape.elements)]
        first += len(shape.elements)
        if mask.any():
            exposed.append(Cells(shape.vertices[mask], shape.elements[mask]))
    return exposed
