"""Search for near pairs of shapes by their bounding balls."""

from __future__ import annotations

from itertools import chain

import numpy as np

RATIO = 2.0
"""Upper limit of the ratio of the radii of balls that are searched together."""
FEW = 50
"""Upper limit of balls of which comparing all pairs costs less than a search."""


def near_balls(centers: np.ndarray, radii: np.ndarray, reach: float) -> np.ndarray:
    """(2, n) sorted pairs of balls whose distance is within reach.

    Balls of similar sizes have a tree of their own, so that few large balls among many small ones
    do not widen the search for pairs of these.

    Parameters
    ----------
    centers : (m, 3)
    radii : (m,)
    """
    if radii.size <= FEW:
        return within_reach(np.stack(np.triu_indices(radii.size, 1)), centers, radii, reach)
    from scipy.spatial import cKDTree

    parts, sizes = [], [(own, cKDTree(centers[own])) for own in _similar(radii)]
    for k, (own, tree) in enumerate(sizes):
        largest = radii[own].max()
        parts.append(own[tree.query_pairs(2 * largest + reach, output_type="ndarray").T])
        for smaller, balls in sizes[k + 1 :]:
            distance = largest + radii[smaller].max() + reach
            lists = balls.query_ball_point(centers[own], distance)
            counts = [len(near) for near in lists]
            others = np.fromiter(chain.from_iterable(lists), int, sum(counts))
            parts.append(np.stack([np.repeat(own, counts), smaller[others]]))
    pairs = within_reach(np.sort(np.hstack(parts), axis=0), centers, radii, reach)
    return pairs[:, np.lexsort(pairs[::-1])]


def within_reach(
    pairs: np.ndarray, centers: np.ndarray, radii: np.ndarray, reach: float
) -> np.ndarray:
    """Those of the pairs (2, n) of balls whose distance is within reach."""
    first, second = pairs
    distance = np.linalg.norm(centers[first] - centers[second], axis=1)
    near: np.ndarray = pairs[:, distance <= radii[first] + radii[second] + reach]
    return near


def _similar(radii: np.ndarray) -> list[np.ndarray]:
    """Numbers of balls of similar radii, the largest first."""
    order, groups = np.argsort(-radii, kind="stable"), []
    while order.size:
        count = int(np.searchsorted(-radii[order], -radii[order[0]] / RATIO, side="right"))
        groups.append(order[:count])
        order = order[count:]
    return groups


def bounding_balls(corners: np.ndarray, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(h, 3) means of the corners of each hull, and (h,) their largest distances from these."""
    counts = np.diff(starts)
    centers = np.add.reduceat(corners, starts[:-1]) / counts[:, None]
    distances = np.linalg.norm(corners - np.repeat(centers, counts, axis=0), axis=1)
    return centers, np.maximum.reduceat(distances, starts[:-1])
