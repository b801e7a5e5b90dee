"""Near features of two cylinders, and of cylinders and walls."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.gaps.cylinders.cylinder_features import (
    AGAINST,
    FLAT,
    ROUNDING,
    TILT,
)
from dalembert.analysis.nonsmooth.gaps.cylinders.cylinders import SECTORS, Cylinders
from dalembert.analysis.nonsmooth.gaps.cylinders.rim_candidates import (
    MEET,
    Evaluate,
    evaluated,
    on_rims,
    rims_at_lines,
    rims_at_rims,
    some_rows,
)
from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps.hulls.planar_features import Rows
from dalembert.analysis.nonsmooth.gaps.hulls.polyhedra import PARALLEL_EDGES
from dalembert.elements.contact.hull import MARKS

ON_END = 1e-9
"""Distance beside the round side that belongs to an end, by the radius."""


def features_at_walls(
    cylinders: Cylinders, normals: np.ndarray, floors: np.ndarray, reach: float
) -> list[tuple[Feature, np.ndarray, np.ndarray]]:
    """Rims, and points on the rims of ends that stand, within reach of walls: the numbers of the
    pairs, and of the rims or corners.

    Parameters
    ----------
    normals, floors : (m, 3) normals of the walls, and (m, 1) coordinates along these
    """
    lowest = (cylinders.lowest(normals) @ normals[:, :, None])[..., 0] - floors
    row, end = np.nonzero(lowest <= reach)
    standing = cylinders.outward @ normals[:, :, None] < -np.sqrt(1 - TILT**2)
    marks = (cylinders.marks @ normals[:, None, :, None])[..., 0] - floors[..., None]
    near, k, mark = np.nonzero((marks <= reach) & standing)
    return [(Feature.WALL_RIM, row, end), (Feature.WALL, near, 2 + k * MARKS + mark)]


def features_of_cylinders(first: Cylinders, second: Cylinders, evaluate: Evaluate) -> list[Rows]:
    """Features of m pairs of cylinders that touch first.

    Each point of one cylinder must not enter the other: rims at ends and at round sides. Rims that
    cross count if their separation is nearly the largest.

    Parameters
    ----------
    evaluate : gaps of rows
    """
    both = (first, second), (second, first)
    rows = [
        part
        for swapped, (own, other) in enumerate(both)
        for part in _rims_at_ends(own, other, bool(swapped))
    ]
    candidates = [
        *(_rims_at_sides(own, other, bool(k), evaluate) for k, (own, other) in enumerate(both)),
        _sides(first, second),
        _crossing(first, second),
    ]
    ends = np.hstack([_separations_at_ends(own, other) for own, other in both])
    size = sum(2 * np.maximum(c.half, c.radii) for c in (first, second))
    best, nearest, gaps = ends.max(axis=1), np.full(size.size, np.inf), []
    for k, candidate in enumerate(candidates):
        part, gap, place, normal = evaluated(candidate, evaluate)
        if part[0] is Feature.RIM_RIM and part[1].size:
            other, foot = second.some(part[1]), place + normal * (gap / 2)[:, None]
            meets = on_rims(foot, other, part[4] // SECTORS) <= MEET * size[part[1]]
            part, gap, normal = some_rows(part, meets), gap[meets], normal[meets]
        candidates[k], separation = part, _separation(part, normal, first, second)
        np.maximum.at(best, part[1], separation)
        valid = gap - separation <= FLAT * size[part[1]]
        if part[0] is not Feature.RIM_RIM:
            valid |= gap > 0  # beside the round side
        gaps.append(np.where(valid, gap, -np.inf))
    for part, gap in zip(candidates, gaps, strict=True):
        near = gap >= best[part[1]] - ROUNDING * size[part[1]]
        rows.append(some_rows(part, near))
        np.minimum.at(nearest, part[1][near], gap[near])
    for part in rows[:4]:
        np.minimum.at(nearest, part[1], evaluated(part, evaluate)[1])
    alone = np.flatnonzero(nearest > best + ROUNDING * size)
    return [*rows, *_lowest_rims(alone, both, ends)]


def _crossing(first: Cylinders, second: Cylinders) -> Rows:
    """Rims that may cross."""
    pair, i, j = rims_at_rims(first, second)
    return Feature.RIM_RIM, pair, np.zeros(pair.size, dtype=bool), i, j


def _separation(rows: Rows, normal: np.ndarray, first: Cylinders, second: Cylinders) -> np.ndarray:
    """(n,) distances of the cylinders of rows along normals (n, 3)."""
    pair, swapped = rows[1:3]
    along = np.where(swapped[:, None], -normal, normal)[:, None]
    distance: np.ndarray = -second.some(pair).farthest(-along) - first.some(pair).farthest(along)
    return distance[:, 0]


def _separations_at_ends(own: Cylinders, other: Cylinders) -> np.ndarray:
    """(m, 2) distances along the outward normals of the ends of the first."""
    distances: np.ndarray = -other.farthest(-own.outward) - own.farthest(own.outward)
    return distances


def _lowest_rims(
    pair: np.ndarray, both: tuple[tuple[Cylinders, Cylinders], ...], ends: np.ndarray
) -> list[Rows]:
    """The lowest rim over the end of the largest separation."""
    best, rows = ends[pair].argmax(axis=1), []
    for swapped, (own, other) in enumerate(both):
        mine = best // 2 == swapped
        p, k = pair[mine], best[mine] % 2
        normal = own.outward[p, k]
        rim = (other.some(p).lowest(normal) @ normal[:, :, None])[..., 0].argmin(axis=1)
        rows.append((Feature.CAP_RIM, p, np.full(p.size, bool(swapped)), k, rim))
    return rows


def _rims_at_ends(own: Cylinders, other: Cylinders, swapped: bool) -> list[Rows]:
    """Lowest points of rims over ends, and points on the rims of ends that stand on ends."""
    lowest = np.stack([other.lowest(own.outward[:, k]) for k in range(2)], axis=1)
    m = lowest.shape[0]
    on_end, end = _on_end(own, lowest.reshape(m, 4, 3))
    k = np.repeat(np.arange(2), 2)
    pair, point = np.nonzero(on_end & (end == k))
    rows = [(Feature.CAP_RIM, pair, np.full(pair.size, swapped), k[point], point % 2)]
    facing = own.outward @ np.swapaxes(other.outward, 1, 2)
    marks = other.marks.reshape(m, -1, 3)
    on_end, end = _on_end(own, marks)
    standing = facing < -np.sqrt(1 - TILT**2)  # (m, own end, other end)
    owner = np.repeat(np.arange(2), MARKS)
    flat = standing[np.arange(m)[:, None], end, owner]
    pair, mark = np.nonzero(on_end & flat)
    rows.append((Feature.CAP, pair, np.full(pair.size, swapped), end[pair, mark], 2 + mark))
    return rows


def _on_end(cylinders: Cylinders, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mask of places nearer to an end than to the round side, and the ends."""
    over, beside, end = cylinders.depths(places)
    limit = ON_END * cylinders.radii[:, None]
    return (beside <= limit) & (over >= beside - limit), end


def _rims_at_sides(own: Cylinders, other: Cylinders, swapped: bool, evaluate: Evaluate) -> Rows:
    """Points of rims nearest to the axis of the other cylinder, beside its round side."""
    ends = other.corners[:, :2]
    axis = (ends[:, 1] - ends[:, 0])[:, None]
    pair, rim, _ = rims_at_lines(own, ends[:, :1], axis)
    rows: Rows = (Feature.RIM_LINE, pair, np.full(pair.size, swapped), rim, 0 * pair)
    rows, gap, place, normal = evaluated(rows, evaluate)
    pair, rim = rows[1], rows[3]
    point, some = place - normal * (gap / 2)[:, None], other.some(pair)
    over, _, end = (column[:, 0] for column in some.depths(point[:, None]))
    near = own.some(pair).outside(rim // SECTORS, point, normal) >= -AGAINST
    opposite = _opposite(own.some(pair), some, point, normal, end)
    near &= (over <= ON_END * some.half) | (opposite & (over <= TILT * some.radii))
    return some_rows(rows, near)


def _opposite(
    own: Cylinders, other: Cylinders, point: np.ndarray, normal: np.ndarray, end: np.ndarray
) -> np.ndarray:
    """Mask of points on rims whose opposite point, on the rim of an end of the other cylinder, is
    beyond their own end: two rims side by side, as of equal cylinders that lie together."""
    row = np.arange(end.size)
    height = ((point - own.center) * own.outward[:, 0]).sum(axis=1)
    axis, middle = other.outward[row, end], other.ends[row, end]
    across = (normal * axis).sum(axis=1, keepdims=True) * axis - normal
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), ON_END)
    there = middle + other.radii[:, None] * across
    side = np.where(height >= 0, 1.0, -1.0)
    beyond: np.ndarray = side * ((there - own.center) * own.outward[:, 0]).sum(axis=1) >= own.half
    return beyond


def _sides(first: Cylinders, second: Cylinders) -> Rows:
    """Axes whose shortest connection is between their ends."""
    u, w = (c.corners[:, 1] - c.corners[:, 0] for c in (first, second))
    across, between = np.cross(u, w), second.corners[:, 0] - first.corners[:, 0]
    square = (across**2).sum(axis=1)
    crossing = square > (4 * PARALLEL_EDGES * first.half * second.half) ** 2
    divisor = np.where(crossing, square, 1.0)
    for line in (w, u):
        fraction = (np.cross(between, line) * across).sum(axis=1) / divisor
        crossing &= (fraction > 0) & (fraction < 1)
    pair = np.flatnonzero(crossing)
    reverse = ((between * across).sum(axis=1) < 0)[pair].astype(int)
    return Feature.EDGES, pair, np.zeros(pair.size, dtype=bool), 0 * pair, reverse
