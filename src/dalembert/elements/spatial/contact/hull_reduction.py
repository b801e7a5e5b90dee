"""Reduction of convex hulls with many corners."""

from __future__ import annotations

import numpy as np


def reduced_hull(points: np.ndarray, most: int) -> tuple[np.ndarray, float]:
    """Numbers of at most ``most`` of the points (n, 3), and the largest distance of the others from
    the planes of their convex hull.

    The corners are extreme along the axes; then the one farthest outside of their hull is added.
    """
    from scipy.spatial import ConvexHull as Qhull

    ends = np.concatenate([points.argmin(axis=0), points.argmax(axis=0)])
    chosen = list(dict.fromkeys(int(k) for k in ends))
    chosen = _with_volume(points, chosen)
    while True:
        planes = Qhull(points[chosen]).equations
        outside = (points @ planes[:, :3].T + planes[:, 3]).max(axis=1)
        outside[chosen] = 0.0
        farthest = int(np.argmax(outside))
        if len(chosen) >= most or outside[farthest] <= 0:
            return np.array(chosen), float(max(outside[farthest], 0.0))
        chosen.append(farthest)


def _with_volume(points: np.ndarray, chosen: list[int]) -> list[int]:
    """The chosen points, and others until they enclose a volume."""
    for _ in range(3):
        relative = points[chosen] - points[chosen[0]]
        basis, sizes, _ = np.linalg.svd(relative.T)
        flat = sizes < 1e-6 * np.ptp(points, axis=0).max()
        rank = int(np.count_nonzero(~flat))
        if rank == 3:
            break
        away = np.abs((points - points[chosen[0]]) @ basis[:, rank:]).max(axis=1)
        chosen = [*chosen, int(np.argmax(away))]
    return chosen
