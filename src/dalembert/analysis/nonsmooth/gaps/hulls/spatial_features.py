"""Near features of spatial rounded hulls."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps.hulls.face_contacts import face_rows
from dalembert.analysis.nonsmooth.gaps.hulls.planar_features import Rows
from dalembert.analysis.nonsmooth.gaps.hulls.polyhedra import (
    Polyhedra,
    corner_separation,
    edge_distances,
    edge_separation,
    face_separation,
    separation,
)

FLAT = 1e-3
"""Height of an edge over a face below which the face touches as well, by the size of the hulls."""
ROUNDING = 1e-12
"""Difference of equal distances, by the size of the hulls."""
NEARLY = 1.5
"""Limit of the distances of corners from edges that touch together, by the smallest."""


def spatial_features(first: Polyhedra, second: Polyhedra, rounded: np.ndarray) -> list[Rows]:
    """Features of m pairs of polyhedra that touch first.

    Parameters
    ----------
    first, second : m polyhedra
    rounded : (m,) whether one of them has a radius
    """
    faces = face_separation(first, second), face_separation(second, first)
    edges, normals = edge_separation(first, second)
    i, j = np.zeros((2, rounded.size), dtype=int)
    corner, beside = np.full((2, rounded.size), -np.inf)
    if rounded.any():
        own, other = first.some(rounded), second.some(rounded)
        i[rounded], j[rounded], corner[rounded] = corner_separation(own, other)
        beside[rounded] = _beside_edges(own, other)
    face, edge = (s.max(axis=1, initial=-np.inf) for s in (np.hstack(faces), edges))
    everything = np.concatenate([first.corners, second.corners], axis=1)
    size = np.ptp(everything, axis=1).max(axis=1)
    flat = (face >= edge - FLAT * size) & (face >= np.maximum(corner, beside) - ROUNDING * size)
    best = np.stack([edge, corner, beside]).argmax(axis=0)
    pair = np.arange(size.size)
    crossed = edge > face + ROUNDING * size  # otherwise any edges around parallel faces
    rows = _faces(pair[flat], first, second, faces, ~crossed)
    crossing = pair[(~flat & (best == 0)) | (flat & crossed)]
    rows = _distinct_edges(rows + _edges(crossing, first, second, edges, normals))
    ends = pair[~flat & (best == 1)]
    rows.append((Feature.CORNERS, ends, np.zeros(ends.size, dtype=bool), i[ends], j[ends]))
    lines = pair[~flat & rounded & (best != 1)]
    rows += _corners_beside_edges(lines, first, second)
    return rows


def _faces(
    pair: np.ndarray,
    first: Polyhedra,
    second: Polyhedra,
    faces: tuple[np.ndarray, np.ndarray],
    farthest: np.ndarray,
) -> list[Rows]:
    """Contacts of pairs along the normal of their best face, ``farthest`` among all axes or not."""
    if not pair.size:
        return []
    k, count = np.hstack(faces)[pair].argmax(axis=1), faces[0].shape[1]
    own = k < count
    a, b = pair[own], pair[~own]
    return [
        *face_rows(a, False, first.some(a), second.some(a), k[own], farthest[a]),
        *face_rows(b, True, second.some(b), first.some(b), k[~own] - count, farthest[b]),
    ]


def _edges(
    pair: np.ndarray, first: Polyhedra, second: Polyhedra, edges: np.ndarray, normals: np.ndarray
) -> list[Rows]:
    """Edges that touch along their common normal."""
    rows: list[Rows] = []
    best = edges[pair].argmax(axis=1) if pair.size else pair
    for column in np.unique(best):
        own = pair[best == column]
        i, j = divmod(int(column), len(second.form.groups))
        normal = normals[own, column]
        one = _outermost(first, own, first.form.groups[i], normal)
        other = _outermost(second, own, second.form.groups[j], -normal)
        across = np.cross(first.lines[own, one], second.lines[own, other])
        reverse = (across * normal).sum(axis=1) < 0
        other = other + reverse * len(second.form.edges)
        rows.append((Feature.EDGES, own, np.zeros(own.size, dtype=bool), one, other))
    return rows


def _distinct_edges(rows: list[Rows]) -> list[Rows]:
    """The rows with each pair of edges once: edges may cross over a face and have the farthest
    common normal, too."""
    crossing = [row for row in rows if row[0] is Feature.EDGES and row[1].size]
    if len(crossing) < 2:
        return rows
    columns = [
        np.concatenate(column) for column in zip(*(row[1:] for row in crossing), strict=True)
    ]
    pair, swapped, own, other = np.unique(np.stack(columns), axis=1)
    others = [row for row in rows if row[0] is not Feature.EDGES]
    return [*others, (Feature.EDGES, pair, swapped.astype(bool), own, other)]


def _outermost(
    polyhedra: Polyhedra, own: np.ndarray, group: np.ndarray, normal: np.ndarray
) -> np.ndarray:
    """Edge of a group that is farthest along a normal."""
    middles = polyhedra.corners[own][:, polyhedra.form.edges[group]].mean(axis=2)
    return group[(middles @ normal[:, :, None])[..., 0].argmax(axis=1)]


def _beside_edges(first: Polyhedra, second: Polyhedra) -> np.ndarray:
    """(m,) distance along the shortest line between a corner and an edge."""
    largest = np.full(first.corners.shape[0], -np.inf)
    for polyhedra, others in ((first, second), (second, first)):
        if polyhedra.form.edges.size:
            distance, vectors = edge_distances(polyhedra, others)
            m, count = distance.shape[0], distance.shape[2]
            e, c = np.divmod(distance.reshape(m, -1).argmin(axis=1), count)
            rows = np.arange(m)
            along = np.where(np.isfinite(distance[rows, e, c])[:, None], vectors[rows, e, c], 0.0)
            largest = np.maximum(largest, separation(polyhedra, others, along))
    return largest


def _corners_beside_edges(pair: np.ndarray, first: Polyhedra, second: Polyhedra) -> list[Rows]:
    """Corners beside edges of rounded hulls: the nearest, and others nearly as near."""
    rows: list[Rows] = []
    if not pair.size:
        return rows
    sides = [
        (False, first.some(pair), second.some(pair)),
        (True, second.some(pair), first.some(pair)),
    ]
    tables = [edge_distances(p, o)[0] if p.form.edges.size else None for _, p, o in sides]
    smallest = np.full(pair.size, np.inf)
    for table in tables:
        if table is not None:
            smallest = np.minimum(smallest, table.min(axis=(1, 2)))
    for (swapped, _, _), table in zip(sides, tables, strict=True):
        if table is not None:
            row, edge, corner = np.nonzero(table <= NEARLY * smallest[:, None, None])
            finite = np.isfinite(smallest[row])
            row, edge, corner = row[finite], edge[finite], corner[finite]
            rows.append((Feature.EDGE, pair[row], np.full(row.size, swapped), edge, corner))
    return rows
