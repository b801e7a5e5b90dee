"""Lines and faces that structures are drawn with, as arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

COIL = np.array([0, 0.2, *np.linspace(0.2, 0.8, 13)[:-1] + 0.025, 0.8, 1])
"""Places of the turns of a drawn spring along its line."""


@dataclass(frozen=True)
class Shapes:
    """Lines or faces with equally many vertices.

    Attributes
    ----------
    vertices : (m, k) numbers of vertices
    owners : (m,) numbers of the elements, over all blocks
    """

    vertices: np.ndarray
    owners: np.ndarray


def turned_tangent(rotation: np.ndarray, chord: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Change of the tangent of a line that turns with its end, as long as the new chord."""
    angle = np.linalg.norm(rotation, axis=1, keepdims=True)
    axis = np.divide(rotation, angle, out=np.zeros_like(rotation), where=angle > 0)
    turned = (
        chord * np.cos(angle)
        + np.cross(axis, chord) * np.sin(angle)
        + axis * np.sum(axis * chord, axis=1, keepdims=True) * (1 - np.cos(angle))
    )
    stretch = np.linalg.norm(after, axis=1) / np.linalg.norm(chord, axis=1)
    return stretch[:, None] * turned - chord


def between(ends: np.ndarray, along: np.ndarray) -> np.ndarray:
    """(ne, s, 3) values between those (2, ne, 3) of the ends."""
    s = along[None, :, None]
    return ends[0][:, None, :] * (1 - s) + ends[1][:, None, :] * s


def samples(count: int) -> int:
    """Points along a curved line: fewer where there are many lines."""
    return 13 if count <= 300 else 7 if count <= 3000 else 3


def lanes(spans: np.ndarray) -> np.ndarray:
    """(ne,) heights at which lines on one axis pass each other, short ones below."""
    found = np.zeros(len(spans), dtype=int)
    placed: list[list[tuple[float, float]]] = []
    for k in np.argsort(spans[:, 1] - spans[:, 0], kind="stable"):
        low, high = spans[k]
        free = (n for n, lane in enumerate(placed) if all(b <= low or a >= high for a, b in lane))
        found[k] = next(free, len(placed))
        if found[k] == len(placed):
            placed.append([])
        placed[found[k]].append((low, high))
    return found


def outside(faces: list[Shapes]) -> list[Shapes]:
    """The faces of solids that belong to one element only."""
    if not faces:
        return []
    width = max(shape.vertices.shape[1] for shape in faces)
    keys = [
        np.pad(np.sort(v := shape.vertices), ((0, 0), (0, width - v.shape[1])), constant_values=-1)
        for shape in faces
    ]
    _, where, counts = np.unique(
        np.concatenate(keys), axis=0, return_inverse=True, return_counts=True
    )
    single = counts[where.ravel()] == 1
    found, first = [], 0
    for shape in faces:
        own = single[first : first + len(shape.owners)]
        first += len(shape.owners)
        if own.any():
            found.append(Shapes(shape.vertices[own], shape.owners[own]))
    return found
