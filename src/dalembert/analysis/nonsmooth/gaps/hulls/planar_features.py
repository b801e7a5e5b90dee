"""Near features of planar rounded polygons, by separating axes.

The axis of two polygons is the normal of an edge, or the line between two corners if one of them is
rounded, along which their distance is largest (Gottschalk, Lin & Manocha 1996). Outside, this is
the distance of the polygons, except between two sharp corners, where it is a lower bound. Where the
edges that meet are nearly parallel, both ends of their common part touch.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature

PARALLEL = 0.7
"""Cosine of the angle of two edges that may touch at two points."""

FLAT = 1e-3
"""Difference of the heights of corners that touch an edge together, by the size of the polygon."""

Rows = tuple[Feature, np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Pair of features; number of the pair of hulls; whether the second hull is first; features."""


@dataclass(frozen=True, eq=False)
class Polygons:
    """Corners of m polygons.

    Attributes
    ----------
    corners : (m, c, 2) anticlockwise, the last one repeated where there are fewer than c
    counts : (m,) numbers of corners; edge k begins at corner k, and a single corner has none
    normals : (m, c, 2) outward normals of the edges; zero for the repeated corners
    """

    corners: np.ndarray
    counts: np.ndarray
    normals: np.ndarray

    @classmethod
    def of(cls, corners: np.ndarray, counts: np.ndarray) -> Polygons:
        """Polygons with these corners."""
        following = np.roll(corners, -1, axis=1)
        m, last = np.arange(counts.size), counts - 1
        following[m, last] = corners[:, 0]
        edge = following - corners
        length = np.hypot(edge[..., 0], edge[..., 1])[..., None]
        edge /= np.where(length > 0, length, 1.0)
        return cls(corners, counts, edge[..., ::-1] * (1.0, -1.0))

    @cached_property
    def has_edge(self) -> np.ndarray:
        """(m, c) whether an edge begins at a corner."""
        number = np.arange(self.corners.shape[1])
        return (number < self.counts[:, None]) & (self.counts[:, None] > 1)

    def some(self, selected: np.ndarray) -> Polygons:
        """The selected polygons."""
        return Polygons(self.corners[selected], self.counts[selected], self.normals[selected])


def planar_features(polygons: Polygons, rounded: np.ndarray) -> list[Rows]:
    """Features of m pairs of polygons that touch first.

    Parameters
    ----------
    polygons : 2 m polygons, the first ones of all pairs before the second ones
    rounded : (m,) whether one polygon of a pair has a radius
    """
    m, count = rounded.size, polygons.corners.shape[1]
    other = np.roll(np.arange(2 * m), m)
    i, j, between = _corner_separation(polygons, rounded)
    edges = _edge_separation(polygons, polygons.some(other))
    best = np.hstack([edges[:m], edges[m:], between[:, None]]).argmax(axis=1)
    corners, pair = np.flatnonzero(best == 2 * count), np.flatnonzero(best < 2 * count)
    swapped, k = np.divmod(best[pair], count)
    own = pair + m * swapped
    none = np.zeros(corners.size, dtype=bool)
    return [
        (Feature.CORNERS, corners, none, i[corners], j[corners]),
        _edge_rows(pair, swapped == 1, polygons.some(own), polygons.some(other[own]), k),
    ]


def _edge_separation(polygons: Polygons, others: Polygons) -> np.ndarray:
    """(m, c) smallest height of the other polygon over each edge."""
    heights = polygons.normals @ np.swapaxes(others.corners, 1, 2)
    lowest = heights.min(axis=2) - np.einsum("mck,mck->mc", polygons.normals, polygons.corners)
    return np.where(polygons.has_edge, lowest, -np.inf)


def _corner_separation(
    polygons: Polygons, rounded: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nearest corners of rounded pairs, and the distance of the polygons along the line between
    these; −∞ for others."""
    m, (i, j) = rounded.size, np.zeros((2, rounded.size), dtype=int)
    separation, rows = np.full(m, -np.inf), np.flatnonzero(rounded)
    if not rows.size:
        return i, j, separation
    first, second = polygons.corners[rows], polygons.corners[m + rows]
    between = second[:, None] - first[:, :, None]
    distance, count = np.linalg.norm(between, axis=3), first.shape[1]
    i[rows], j[rows] = np.divmod(distance.reshape(rows.size, -1).argmin(axis=1), count)
    own = np.arange(rows.size), i[rows], j[rows]
    apart = distance[own] > 0
    direction = between[own] / np.where(apart, distance[own], 1.0)[:, None]
    ends = [(corners @ direction[:, :, None])[..., 0] for corners in (first, second)]
    separation[rows] = np.where(apart, ends[1].min(axis=1) - ends[0].max(axis=1), -np.inf)
    return i, j, separation


def _edge_rows(
    pair: np.ndarray, swapped: np.ndarray, polygons: Polygons, others: Polygons, k: np.ndarray
) -> Rows:
    """Corners of the others over edge ``k`` of each polygon, and of the polygon under theirs."""
    rows, counts = np.arange(pair.size), others.counts
    start, normal = polygons.corners[rows, k], polygons.normals[rows, k]
    tangent = normal[:, ::-1] * (-1.0, 1.0)
    relative = others.corners - start[:, None]
    heights = (relative @ normal[:, :, None])[..., 0]
    along = (relative @ tangent[:, :, None])[..., 0]
    facing = (others.normals @ normal[:, :, None])[..., 0]
    lowest = heights.argmin(axis=1)
    previous = (lowest - 1) % counts
    e = np.where(facing[rows, previous] < facing[rows, lowest], previous, lowest)
    after, following = (e + 1) % counts, (k + 1) % polygons.counts
    ends = np.stack([start, polygons.corners[rows, following]], axis=1)
    length = np.einsum("mk,mk->m", ends[:, 1] - start, tangent)
    upper, lower = along[rows, e], along[rows, after]
    flush = (facing[rows, e] < -PARALLEL) & (upper >= 0) & (lower <= length)
    first = others.corners[rows, e]
    edge, from_first = others.corners[rows, after] - first, ends - first[:, None]
    part = (from_first @ edge[:, :, None])[..., 0]
    beside = (part >= 0) & (part <= np.einsum("mk,mk->m", edge, edge)[:, None])
    depth = (from_first @ others.normals[rows, e][:, :, None])[..., 0]
    begins, finishes = flush & (lower >= 0), flush & (upper <= length)
    under, over = flush & beside[:, 0] & ~begins, flush & beside[:, 1] & ~finishes
    touching = np.stack([begins, finishes, under, over])
    gaps = np.stack([heights[rows, after], heights[rows, e], depth[:, 0], depth[:, 1]])
    nearest = np.where(touching, gaps, np.inf).min(axis=0)
    size = np.ptp(others.corners, axis=1).max(axis=1, initial=0.0)
    alone = nearest > heights[rows, lowest] + FLAT * size  # a corner beside the edge
    kind, row = np.nonzero(np.concatenate([alone[None], touching]))
    edges, corners = np.stack([k, k, k, e, e]), np.stack([lowest, after, e, k, following])
    first_shape = swapped[row] ^ (kind > 2)
    return Feature.FACE, pair[row], first_shape, edges[kind, row], corners[kind, row]
