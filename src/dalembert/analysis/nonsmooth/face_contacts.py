"""Contacts of a face with the face, edge or corner of another hull that meets it."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.gap_functions import Feature
from dalembert.analysis.nonsmooth.planar_features import PARALLEL, Rows
from dalembert.analysis.nonsmooth.polyhedra import Polyhedra

ON_EDGE = 1e-9
"""Distance of a corner from a side of a face within which it is on this side, by its length."""


def face_rows(
    pair: np.ndarray, swapped: bool, polyhedra: Polyhedra, others: Polyhedra, f: np.ndarray
) -> list[Rows]:
    """Corners over face ``f``, corners under the face of the other, and edges that cross.

    Parameters
    ----------
    pair : (m,) numbers of the pairs of hulls
    swapped : whether the face belongs to the second hull of the pair
    polyhedra, others : m hulls with the face, and the other ones
    f : (m,) numbers of the faces
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
    under = np.zeros_like(own_real)
    if flush.any():
        opposite = others.normals[rows, g]
        under = own_real & flush[:, None] & (_depth(other, real, opposite, face) > ON_EDGE)
    touching = [
        _rows(pair, swapped, f, loop, over),
        _rows(pair, not swapped, g, own_loop, under),
    ]
    crossing = _crossings(pair, swapped, polyhedra, others, f, g, normal)
    met = np.zeros(pair.size, dtype=bool)
    met[over.any(axis=1) | under.any(axis=1)] = True
    met |= np.isin(pair, crossing[1])
    lowest = heights.argmin(axis=1)
    alone = np.full((~met).sum(), swapped)
    single = (Feature.FACE, pair[~met], alone, f[~met], lowest[~met])
    return [*touching, crossing, single]


def _rows(
    pair: np.ndarray, swapped: bool, f: np.ndarray, loop: np.ndarray, selected: np.ndarray
) -> Rows:
    row, k = np.nonzero(selected)
    return Feature.FACE, pair[row], np.full(row.size, swapped), f[row], loop[row, k]


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
    pair: np.ndarray,
    swapped: bool,
    polyhedra: Polyhedra,
    others: Polyhedra,
    f: np.ndarray,
    g: np.ndarray,
    normal: np.ndarray,
) -> Rows:
    """Sides of the faces that cross in the view along the normal."""
    own, form, rows = polyhedra.form, others.form, np.arange(pair.size)[:, None]
    none = np.zeros(0, dtype=int)
    if not form.edges.size:
        return Feature.EDGES, none, none.astype(bool), none, none
    sides = own.sides[f], form.sides[g]
    number = np.arange(sides[0].shape[1]), np.arange(sides[1].shape[1])
    counts = own.counts[f], np.where(form.has_faces, form.counts[g], 1)
    real = [n < c[:, None] for n, c in zip(number, counts, strict=True)]
    starts = [
        p.corners[rows, p.form.edges[s][..., 0]]
        for p, s in ((polyhedra, sides[0]), (others, sides[1]))
    ]
    lines = [p.lines[rows, s] for p, s in ((polyhedra, sides[0]), (others, sides[1]))]
    u, w = lines[0][:, :, None], lines[1][:, None]
    between, view = starts[1][:, None] - starts[0][:, :, None], normal[:, None, None]
    across = np.cross(u, w)
    area = (across * view).sum(axis=3)
    size = np.linalg.norm(across, axis=3)
    crosses = real[0][:, :, None] & real[1][:, None] & (np.abs(area) > PARALLEL * size)
    crosses &= size > ON_EDGE * np.linalg.norm(u, axis=3) * np.linalg.norm(w, axis=3)
    divisor = np.where(crosses, area, 1.0)
    fractions = [(np.cross(between, other) * view).sum(axis=3) / divisor for other in (w, u)]
    for fraction in fractions:
        crosses &= (fraction > ON_EDGE) & (fraction < 1 - ON_EDGE)
    row, a, b = np.nonzero(crosses)
    first, second = sides[0][row, a], sides[1][row, b]
    reverse = area[row, a, b] < 0
    return (
        Feature.EDGES,
        pair[row],
        np.full(row.size, swapped),
        first,
        second + reverse * len(form.edges),
    )
