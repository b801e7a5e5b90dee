"""Search for near pairs of shapes by their bounding balls."""

from __future__ import annotations

import numpy as np


def near_balls(centers: np.ndarray, radii: np.ndarray, reach: float) -> np.ndarray:
    """(2, n) sorted pairs of balls whose distance is within reach.

    Parameters
    ----------
    centers : (m, 3)
    radii : (m,)
    """
    if radii.size < 2:
        return np.zeros((2, 0), dtype=int)
    from scipy.spatial import cKDTree

    first, second = cKDTree(centers).query_pairs(2 * radii.max() + reach, output_type="ndarray").T
    distance = np.linalg.norm(centers[first] - centers[second], axis=1)
    near = distance <= radii[first] + radii[second] + reach
    pairs = np.stack([first[near], second[near]])
    return pairs[:, np.lexsort(pairs[::-1])]


def bounding_balls(corners: np.ndarray, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(h, 3) means of the corners of each hull, and (h,) their largest distances from these."""
    counts = np.diff(starts)
    centers = np.add.reduceat(corners, starts[:-1]) / counts[:, None]
    distances = np.linalg.norm(corners - np.repeat(centers, counts, axis=0), axis=1)
    return centers, np.maximum.reduceat(distances, starts[:-1])
