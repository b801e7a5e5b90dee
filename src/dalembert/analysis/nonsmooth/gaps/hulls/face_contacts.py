"""Contacts of a face with the face, edge or corner of another hull that meets it."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps.hulls.planar_features import PARALLEL, Rows
from dalembert.analysis.nonsmooth.gaps.hulls.polyhedra import Polyhedra

FLAT = 1e-3
"""Difference of the heights of corners that touch a face together, by the size of the hull."""
SAME = 1e-8
"""Distance of two corners over each other, by the size of the hull."""
ON_EDGE = 1e-9
"""Distance of a corner from a side of a face within which it is on this side, by its length."""


def face_rows(
    pair: np.ndarray,
    swapped: bool,
    polyhedra: Polyhedra,
    others: Polyhedra,
    f: np.ndarray,
    farthest: np.ndarray,
) -> list[Rows]:
    """Corners over face ``f``, corners under the face of the other, and edges that cross.

    Where all of these are higher than the lowest corner, which is beside the face, that corner if
    the normal of the face is the axis of the largest distance.

    Parameters
    ----------
    pair : (m,) numbers of the pairs of hulls
    swapped : whether the face belongs to the second hull of the pair
    polyhedra, others : m hulls with the face, and the other ones
    f : (m,) numbers of the faces
    farthest : (m,) whether no other axis has a larger distance
    """
    if not pair.size:
        return []
    rows, own, form = np.arange(pair.size), polyhedra.form, others.form
    normal = polyhedra.normals[rows, f]
    heights = (others.corners @ normal[:, :, None])[..., 0]
    if form.has_faces:
        facing = (others.normals @ normal[:, :, None])[..., 0]
        g = facing.argmin(axis=1)
        flush = facing[rows, g] < -PARALLEL
    else:
        g, flush = np.zeros_like(f), np.zeros(pair.size, dtype=bool)
    loop, own_loop = form.loops[g], own.loops[f]
    face, other = polyhedra.corners[rows[:, None], own_loop], others.corners[rows[:, None], loop]
    real = np.arange(loop.shape[1]) < form.counts[g][:, None]
    own_real = np.arange(own_loop.shape[1]) < own.counts[f][:, None]
    over = real & (_depth(face, own_real, normal, other) >= -ON_EDGE)
    under, opposite = np.zeros_like(own_real), -normal
    if flush.any():
        opposite = others.normals[rows, g]
        under = own_real & flush[:, None] & (_depth(other, real, opposite, face) >= -ON_EDGE)
        under &= ~_over_corners(face, other, over, normal)
    touched = over.any(axis=1) | under.any(axis=1)
    (a, b), reverse, crossed, apart = _crossings(polyhedra, others, f, g, normal, touched)
    start = (face[:, 0] * normal).sum(axis=1)
    nearest = np.where(over, heights[rows[:, None], loop], np.inf).min(axis=1) - start
    if flush.any():
        below = ((face - other[:, :1]) * opposite[:, None]).sum(axis=2)
        nearest = np.minimum(nearest, np.where(under, below, np.inf).min(axis=1))
    np.minimum.at(nearest, crossed, apart)
    lowest = heights.argmin(axis=1)
    size = np.ptp(others.corners, axis=1).max(axis=1)
    alone = nearest > heights[rows, lowest] - start + FLAT * size  # a corner beside the face
    alone &= farthest
    sides = np.full(int(alone.sum()), swapped)
    ends, reversed_edges = ((b, a), own.edges) if swapped else ((a, b), form.edges)
    edges = ends[0], ends[1] + reverse * len(reversed_edges)
    return [
        _rows(pair, swapped, f, loop, over),
        _rows(pair, not swapped, g, own_loop, under),
        (Feature.EDGES, pair[crossed], np.zeros(crossed.size, dtype=bool), *edges),
        (Feature.FACE, pair[alone], sides, f[alone], lowest[alone]),
    ]


def _over_corners(
    places: np.ndarray, corners: np.ndarray, selected: np.ndarray, normal: np.ndarray
) -> np.ndarray:
    """(m, k) mask of places (m, k, 3) that are over a selected corner (m, l, 3) along a normal."""
    between = places[:, :, None] - corners[:, None]
    heights = (between * normal[:, None, None]).sum(axis=3)
    distances = np.linalg.norm(between - heights[..., None] * normal[:, None, None], axis=3)
    limit = SAME * np.ptp(corners, axis=1).max(axis=1)
    over: np.ndarray = (selected[:, None] & (distances <= limit[:, None, None])).any(axis=2)
    return over


def _rows(
    pair: np.ndarray, swapped: bool, f: np.ndarray, loop: np.ndarray, selected: np.ndarray
) -> Rows:
    row, k = np.nonzero(selected)
    return Feature.FACE, pair[row], np.full(row.size, swapped), f[row], loop[row, k]


def depth_in_face(polyhedra: Polyhedra, f: np.ndarray, places: np.ndarray) -> np.ndarray:
    """(m, k) smallest distances of places (m, k, 3) from the sides of face ``f`` of each hull, by
    the lengths of the sides; positive inside."""
    rows, loop = np.arange(f.size), polyhedra.form.loops[f]
    real = np.arange(loop.shape[1]) < polyhedra.form.counts[f][:, None]
    face = polyhedra.corners[rows[:, None], loop]
    return _depth(face, real, polyhedra.normals[rows, f], places)


def _depth(
    face: np.ndarray, real: np.ndarray, normal: np.ndarray, places: np.ndarray
) -> np.ndarray:
    """(m, k) smallest distances of places (m, k, 3) from the sides of faces (m, l, 3), by the
    lengths of the sides; positive inside."""
    sides = _following(face, real) - face
    length = np.linalg.norm(sides, axis=2, keepdims=True)
    inward = np.cross(normal[:, None], sides) / np.where(length > 0, length, 1.0) ** 2
    depth = ((places[:, None] - face[:, :, None]) * inward[:, :, None]).sum(axis=3)
    return np.where(real[:, :, None], depth, np.inf).min(axis=1)


def _following(loop: np.ndarray, real: np.ndarray) -> np.ndarray:
    """The next corners of loops (m, l, 3)."""
    following = np.roll(loop, -1, axis=1)
    m, last = np.arange(loop.shape[0]), real.sum(axis=1) - 1
    following[m, last] = loop[:, 0]
    return following


def _crossings(
    polyhedra: Polyhedra,
    others: Polyhedra,
    f: np.ndarray,
    g: np.ndarray,
    normal: np.ndarray,
    touched: np.ndarray,
) -> tuple[tuple[np.ndarray, np.ndarray], np.ndarray, np.ndarray, np.ndarray]:
    """Sides of the faces whose shortest connection is nearly along the normal, between their ends;
    at an end, as an edge over two corners, where no corner touches, by the mask ``touched`` (m,).

    Returns their numbers, whether one is reversed, the pair of faces, and the distance.
    """
    own, form, rows = polyhedra.form, others.form, np.arange(f.size)[:, None]
    none = np.zeros(0, dtype=int)
    if not form.edges.size:
        return (none, none), none, none, np.zeros(0)
    sides = own.sides[f], form.sides[g]
    counts = own.counts[f], form.counts[g] if form.has_faces else np.ones_like(g)
    real = [np.arange(s.shape[1]) < c[:, None] for s, c in zip(sides, counts, strict=True)]
    hulls = list(zip((polyhedra, others), sides, strict=True))
    starts = [hull.corners[rows, hull.form.edges[s][..., 0]] for hull, s in hulls]
    u, w = (hull.lines[rows, s] for hull, s in hulls)
    u, w, view = u[:, :, None], w[:, None], normal[:, None, None]
    between = starts[1][:, None] - starts[0][:, :, None]
    across = np.cross(u, w)
    area, size = (across * view).sum(axis=3), np.linalg.norm(across, axis=3)
    crosses = real[0][:, :, None] & real[1][:, None] & (np.abs(area) > PARALLEL * size)
    crosses &= size > ON_EDGE * np.linalg.norm(u, axis=3) * np.linalg.norm(w, axis=3)
    divisor = np.where(crosses, size, 1.0) ** 2
    first, second = ((np.cross(between, v) * across).sum(axis=3) / divisor for v in (w, u))
    inside = np.minimum(np.minimum(first, 1 - first), np.minimum(second, 1 - second))
    between_ends = crosses & (inside > ON_EDGE)
    touched = touched | between_ends.any(axis=(1, 2))
    crosses = np.where(touched[:, None, None], between_ends, crosses & (inside > -ON_EDGE))
    apart = np.sign(area) * (between * across).sum(axis=3) / np.sqrt(divisor)
    row, a, b = np.nonzero(crosses)
    numbers = sides[0][row, a], sides[1][row, b]
    return numbers, area[row, a, b] < 0, row, apart[row, a, b]
