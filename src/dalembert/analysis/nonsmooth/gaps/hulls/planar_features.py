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
    """

    corners: np.ndarray
    counts: np.ndarray

    @cached_property
    def normals(self) -> np.ndarray:
        """(m, c, 2) outward normals of the edges; zero for the repeated corners."""
        following = np.roll(self.corners, -1, axis=1)
        m, last = np.arange(self.counts.size), self.counts - 1
        following[m, last] = self.corners[:, 0]
        edge = following - self.corners
        length = np.linalg.norm(edge, axis=2, keepdims=True)
        edge /= np.where(length > 0, length, 1.0)
        return np.stack([edge[..., 1], -edge[..., 0]], axis=2)

    @cached_property
    def has_edge(self) -> np.ndarray:
        """(m, c) whether an edge begins at a corner."""
        number = np.arange(self.corners.shape[1])
        return (number < self.counts[:, None]) & (self.counts[:, None] > 1)

    def some(self, selected: np.ndarray) -> Polygons:
        """The selected polygons."""
        return Polygons(self.corners[selected], self.counts[selected])


def planar_features(first: Polygons, second: Polygons, rounded: np.ndarray) -> list[Rows]:
    """Features of m pairs of polygons that touch first.

    Parameters
    ----------
    first, second : m polygons
    rounded : (m,) whether one of them has a radius
    """
    i, j, between = _corner_separation(first, second, rounded)
    axes = _edge_separation(first, second), _edge_separation(second, first)
    best = np.hstack([*axes, between[:, None]]).argmax(axis=1)
    sizes = axes[0].shape[1], axes[1].shape[1]
    pair = np.arange(best.size)
    corners = pair[best == sum(sizes)]
    none = np.zeros(corners.size, dtype=bool)
    rows: list[Rows] = [(Feature.CORNERS, corners, none, i[corners], j[corners])]
    own, other = pair[best < sizes[0]], pair[(best >= sizes[0]) & (best < sum(sizes))]
    rows += _edge_rows(own, False, first.some(own), second.some(own), best[own])
    rows += _edge_rows(other, True, second.some(other), first.some(other), best[other] - sizes[0])
    return rows


def _edge_separation(polygons: Polygons, others: Polygons) -> np.ndarray:
    """(m, c) smallest height of the other polygon over each edge."""
    heights = polygons.normals @ np.swapaxes(others.corners, 1, 2)
    lowest = heights.min(axis=2) - (polygons.normals * polygons.corners).sum(axis=2)
    return np.where(polygons.has_edge, lowest, -np.inf)


def _corner_separation(
    first: Polygons, second: Polygons, rounded: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nearest corners, and the distance of the polygons along the line between these."""
    between = second.corners[:, None] - first.corners[:, :, None]
    distance = np.linalg.norm(between, axis=3)
    m, count = distance.shape[0], distance.shape[2]
    i, j = np.divmod(distance.reshape(m, -1).argmin(axis=1), count)
    rows = np.arange(m)
    length = distance[rows, i, j]
    apart = rounded & (length > 0)
    direction = between[rows, i, j] / np.where(apart, length, 1.0)[:, None]
    ends = [(p.corners @ direction[:, :, None])[..., 0] for p in (first, second)]
    return i, j, np.where(apart, ends[1].min(axis=1) - ends[0].max(axis=1), -np.inf)


def _edge_rows(
    pair: np.ndarray, swapped: bool, polygons: Polygons, others: Polygons, k: np.ndarray
) -> list[Rows]:
    """Corners of the others over edge ``k`` of each polygon, and of the polygon under theirs."""
    rows, counts = np.arange(pair.size), others.counts
    start, normal = polygons.corners[rows, k], polygons.normals[rows, k]
    heights = ((others.corners - start[:, None]) @ normal[:, :, None])[..., 0]
    lowest = heights.argmin(axis=1)
    facing = (others.normals @ normal[:, :, None])[..., 0]
    previous = (lowest - 1) % counts
    e = np.where(facing[rows, previous] < facing[rows, lowest], previous, lowest)
    after, following = (e + 1) % counts, (k + 1) % polygons.counts
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    length = ((polygons.corners[rows, following] - start) * tangent).sum(axis=1)
    upper, lower = (((others.corners[rows, c] - start) * tangent).sum(axis=1) for c in (e, after))
    flush = (facing[rows, e] < -PARALLEL) & (upper >= 0) & (lower <= length)
    begins, ends = flush & (lower >= 0), flush & (upper <= length)
    places = [polygons.corners[rows, c] for c in (k, following)]
    under, over = (_beside(others, e, after, place) & flush for place in places)
    under, over = under & ~begins, over & ~ends
    opposite, first = others.normals[rows, e], others.corners[rows, e]
    touching = [(begins, heights[rows, after]), (ends, heights[rows, e])]
    for selected, place in zip((under, over), places, strict=True):
        touching.append((selected, ((place - first) * opposite).sum(axis=1)))
    nearest = np.min([np.where(*pairs, np.inf) for pairs in touching], axis=0)
    size = np.ptp(others.corners, axis=1).max(axis=1, initial=0.0)
    alone = nearest > heights[rows, lowest] + FLAT * size  # a corner beside the edge
    return [
        _face(pair, swapped, k, lowest, alone),
        _face(pair, swapped, k, after, begins),
        _face(pair, swapped, k, e, ends),
        _face(pair, not swapped, e, k, under),
        _face(pair, not swapped, e, following, over),
    ]


def _beside(
    polygons: Polygons, start: np.ndarray, end: np.ndarray, places: np.ndarray
) -> np.ndarray:
    """Mask of places whose nearest point of the line through an edge is on the edge."""
    rows = np.arange(start.size)
    first, edge = polygons.corners[rows, start], polygons.corners[rows, end]
    along = ((places - first) * (edge - first)).sum(axis=1)
    return (along >= 0) & (along <= ((edge - first) ** 2).sum(axis=1))


def _face(
    pair: np.ndarray, swapped: bool, edge: np.ndarray, corner: np.ndarray, selected: np.ndarray
) -> Rows:
    """Rows of selected edges and corners."""
    first = np.full(int(selected.sum()), swapped)
    return Feature.FACE, pair[selected], first, edge[selected], corner[selected]
