"""Triangles of a region whose boundary is given as segments: conforming Delaunay refinement."""

from __future__ import annotations

import numpy as np

from dalembert.errors import ModelError
from dalembert.model.meshes.boundary import Boundary

ROUNDS = 60
"""Upper limit of refinements."""
ANGLE = 1.3
"""Largest radius of the circumcircle relative to the shortest edge: angles of at least 22.6°."""
LARGEST = 0.72
"""Largest radius of the circumcircle, relative to the size; 0.577 where triangles are regular."""
SMOOTHING = 4
"""Number of times that inner points move to the mean of their neighbours."""
APART = 0.6
"""Least distance of points of the first lattice from the boundary, relative to the size."""


def triangulate(boundary: Boundary, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Points and counter-clockwise triangles of a region; points of the boundary come first.

    Delaunay triangulation of the boundary and of a lattice of equilateral triangles, to which
    centres of circumcircles of large or flat triangles are added, or midpoints of segments of the
    boundary into whose diametral circle these would fall: Ruppert, A Delaunay refinement algorithm,
    Journal of Algorithms 18 (1995). Segments at a corner are divided at powers of two of the
    distance from it, so that the refinement ends at acute corners too.

    Parameters
    ----------
    boundary : gets further points where segments are divided
    size : length of edges [m]

    Returns
    -------
    points (count, 2) [m], triangles (cells, 3)

    Raises
    ------
    ModelError
        The region is too narrow for this size.
    """
    inner = _lattice(boundary, size)
    for _ in range(ROUNDS):
        points = np.vstack([boundary.points, inner])
        triangles = _inside(points, _delaunay(points), boundary)
        missing = _missing(boundary, triangles)
        if missing:
            boundary.divide(missing)
            continue
        added, crowded = _refinements(points, triangles, boundary, size)
        if not len(added) and not crowded:
            break
        boundary.divide(crowded)
        inner = np.vstack([inner, added])
    for _ in range(SMOOTHING):
        inner, points, triangles = _smoothed(boundary, points, triangles)
    if _missing(boundary, triangles):
        raise ModelError("the region is too narrow for a mesh of this size; take a smaller one")
    return points, triangles


def _delaunay(points: np.ndarray) -> np.ndarray:
    from scipy.spatial import Delaunay, QhullError

    try:
        return np.asarray(Delaunay(points).simplices)
    except QhullError:
        raise ModelError("the vertices do not enclose an area") from None


def _corners(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, ...]:
    return points[triangles[:, 0]], points[triangles[:, 1]], points[triangles[:, 2]]


def _areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = _corners(points, triangles)
    u, v = b - a, c - a
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2


def _inside(points: np.ndarray, triangles: np.ndarray, boundary: Boundary) -> np.ndarray:
    """The triangles within the region, counter-clockwise."""
    areas = _areas(points, triangles)
    longest = np.ptp(points, axis=0).max()
    kept = np.abs(areas) > 1e-12 * longest**2
    triangles, areas = triangles[kept], areas[kept]
    triangles = np.where((areas < 0)[:, None], triangles[:, [0, 2, 1]], triangles)
    return triangles[boundary.contains(points[triangles].mean(axis=1))]


def _lattice(boundary: Boundary, size: float) -> np.ndarray:
    """Equilateral lattice within the region, away from its boundary."""
    low, high = boundary.points.min(axis=0), boundary.points.max(axis=0)
    height = size * np.sqrt(0.75)
    rows = np.arange(low[1] + height / 2, high[1], height)
    columns = np.arange(low[0] - size, high[0] + size, size)
    x, y = np.meshgrid(columns, rows)
    x = x + np.where(np.arange(len(rows)) % 2, size / 2, 0.0)[:, None]
    points = np.column_stack([x.ravel(), y.ravel()])
    points = points[boundary.contains(points)]
    return points[boundary.distance(points, 2 * size) > APART * size] if len(points) else points


def _edges(triangles: np.ndarray) -> np.ndarray:
    """Edges of triangles (3 cells, 2), the smaller number first."""
    pairs = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.sort(pairs, axis=1)


def _missing(boundary: Boundary, triangles: np.ndarray) -> list[int]:
    """Numbers of the segments that are no edges of triangles."""
    present = set(map(tuple, np.unique(_edges(triangles), axis=0).tolist()))
    ends = np.sort(boundary.ends, axis=1).tolist()
    return [k for k, pair in enumerate(ends) if tuple(pair) not in present]


def _refinements(
    points: np.ndarray, triangles: np.ndarray, boundary: Boundary, size: float
) -> tuple[np.ndarray, list[int]]:
    """Points to add, and segments to divide instead of those that lie too near."""
    a, b, c = _corners(points, triangles)
    edges = np.stack([np.linalg.norm(p - q, axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=1)
    area = _areas(points, triangles)
    radius = edges.prod(axis=1) / (4 * area)
    shortest = edges.min(axis=1)
    poor = (radius > LARGEST * size) | (radius > ANGLE * shortest)
    poor &= ~boundary.at_sharp_corner(triangles) & (shortest > size / 256)
    if not poor.any():
        return np.zeros((0, 2)), []
    u, v = (b - a)[poor], (c - a)[poor]
    uu, vv = (u**2).sum(axis=1), (v**2).sum(axis=1)
    twice = 4 * area[poor]
    centre = a[poor] + np.column_stack(
        [(v[:, 1] * uu - u[:, 1] * vv) / twice, (u[:, 0] * vv - v[:, 0] * uu) / twice]
    )
    order = np.argsort(-radius[poor])[: max(8, len(triangles) // 4)]
    centre, reach = centre[order], radius[poor][order]
    crowded = boundary.encroached(centre)
    divided = sorted({int(k) for row in crowded for k in row if boundary.divisible(int(k), size)})
    free = np.array([not len(row) for row in crowded]) & boundary.contains(centre)
    chosen: list[int] = []
    for k in np.flatnonzero(free):
        others = centre[chosen]
        if not chosen or (np.linalg.norm(others - centre[k], axis=1) > reach[k]).all():
            chosen.append(int(k))
    return centre[chosen], divided


def _smoothed(
    boundary: Boundary, points: np.ndarray, triangles: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Inner points at the mean of their neighbours, where no triangle turns over."""
    first = len(boundary.points)
    pairs = np.unique(_edges(triangles), axis=0)
    both = np.vstack([pairs, pairs[:, ::-1]])
    count = np.bincount(both[:, 0], minlength=len(points))
    sums = np.column_stack(
        [np.bincount(both[:, 0], points[both[:, 1], k], minlength=len(points)) for k in (0, 1)]
    )
    used = count > 0
    used[:first] = True
    moved = points.copy()
    inner = np.flatnonzero(used[first:]) + first
    moved[inner] = sums[inner] / count[inner, None]
    moved = moved[used]
    after = _inside(moved, _delaunay(moved), boundary)
    if _missing(boundary, after) or np.unique(after).size < len(moved):
        kept = np.cumsum(used) - 1
        return points[used][first:], points[used], kept[triangles]
    return moved[first:], moved, after
