"""Convex polyhedra of equal form, with separating axes of pairs.

The axis of two polyhedra is the normal of a face, the common normal of two edges or, if one of them
is rounded, the shortest line between corners and edges, along which their distance is largest
(Gottschalk, Lin & Manocha 1996).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dalembert.elements.contact.hull import Hull

OUTERMOST = 1e-9
"""Distance from the outermost corner of an edge that is outermost, by the size of the hulls."""
PARALLEL_EDGES = 1e-6
"""Sine of the angle of two edges without a common normal."""


class Form:
    """Corners, edges and faces of a hull, by numbers.

    Parameters
    ----------
    hull : Hull

    Attributes
    ----------
    edges : (e, 2) corners
    groups, begins : edges of equal direction, and (g, k) corners where these begin
    loops, counts : (f, l) corners of the faces, the last one repeated, and (f,) their numbers; a
        hull without faces has its edge or corner as a loop
    sides : (f, l) edge that begins at a corner of a loop
    has_faces : whether its loops are faces
    """

    def __init__(self, hull: Hull):
        self.edges = np.array(hull.edges, dtype=int).reshape(-1, 2)
        self.groups = [np.array(group) for group in hull.parallel_edges]
        longest = max((group.size for group in self.groups), default=1)
        repeated = [np.resize(group, longest) for group in self.groups]
        self.begins = self.edges[np.array(repeated, dtype=int).reshape(-1, longest), 0]
        self.has_faces = bool(hull.faces)
        loops = hull.faces or hull.edges or ((0,),)
        self.counts = np.array([len(loop) for loop in loops])
        longest = int(self.counts.max())
        self.loops = np.array([[*loop, *loop[-1:] * (longest - len(loop))] for loop in loops])
        numbers = {frozenset(edge): k for k, edge in enumerate(hull.edges)}
        following = [[*loop[1:], loop[0]] for loop in loops]
        self.sides = np.zeros_like(self.loops)
        for f, (loop, after) in enumerate(zip(loops, following, strict=True)):
            for k, ends in enumerate(zip(loop, after, strict=True)):
                self.sides[f, k] = numbers.get(frozenset(ends), 0)


@dataclass(frozen=True, eq=False)
class Polyhedra:
    """Corners (m, c, 3) of polyhedra of one form."""

    corners: np.ndarray
    form: Form

    @cached_property
    def normals(self) -> np.ndarray:
        """(m, f, 3) outward normals of the faces; none without faces."""
        if not self.form.has_faces:
            return self.corners[:, :0]
        a, b, c = (self.corners[:, self.form.loops[:, k]] for k in range(3))
        return _unit(np.cross(b - a, c - b))

    @cached_property
    def lines(self) -> np.ndarray:
        """(m, e, 3) edges as vectors."""
        ends = self.corners[:, self.form.edges]
        return ends[:, :, 1] - ends[:, :, 0]

    @cached_property
    def directions(self) -> np.ndarray:
        """(m, g, 3) unit vectors along the groups of edges."""
        first = [int(group[0]) for group in self.form.groups]
        return _unit(self.lines[:, first])

    def some(self, selected: np.ndarray) -> Polyhedra:
        """The selected polyhedra."""
        return Polyhedra(self.corners[selected], self.form)


def face_separation(polyhedra: Polyhedra, others: Polyhedra) -> np.ndarray:
    """(m, f) smallest height of the other polyhedron over each face."""
    normals = polyhedra.normals
    heights = normals @ np.swapaxes(others.corners, 1, 2)
    starts = polyhedra.corners[:, polyhedra.form.loops[: normals.shape[1], 0]]
    return heights.min(axis=2) - (normals * starts).sum(axis=2)


def edge_separation(first: Polyhedra, second: Polyhedra) -> tuple[np.ndarray, np.ndarray]:
    """(m, n) distances along the common normals of groups of edges, and (m, n, 3) these normals.

    Only edges that are outermost along the normal count; others are −∞.
    """
    m, counts = first.corners.shape[0], (len(first.form.groups), len(second.form.groups))
    if not all(counts):
        return np.zeros((m, 0)), np.zeros((m, 0, 3))
    normals = np.cross(first.directions[:, :, None], second.directions[:, None]).reshape(m, -1, 3)
    length = np.linalg.norm(normals, axis=2)
    valid = length > PARALLEL_EDGES
    normals = normals / np.where(valid, length, 1.0)[..., None]
    i, j = (normals @ np.swapaxes(p.corners, 1, 2) for p in (first, second))
    behind = (i.min(axis=2) - j.max(axis=2) > j.min(axis=2) - i.max(axis=2))[..., None]
    normals, i, j = (np.where(behind, -s, s) for s in (normals, i, j))
    highest, lowest = i.max(axis=2), j.min(axis=2)
    shape = (m, *counts, -1)
    columns = first.form.begins[None, :, None], second.form.begins[None, None]
    ends = [
        np.take_along_axis(s.reshape(shape), c, axis=3)
        for s, c in zip((i, j), columns, strict=True)
    ]
    inner = (
        highest - ends[0].max(axis=3).reshape(m, -1),
        ends[1].min(axis=3).reshape(m, -1) - lowest,
    )
    size = sum(np.ptp(hulls.corners, axis=1).max(axis=1) for hulls in (first, second))
    valid &= np.maximum(*inner) < OUTERMOST * size[:, None]
    return np.where(valid, lowest - highest, -np.inf), normals


def corner_separation(
    first: Polyhedra, second: Polyhedra
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of the nearest corners, and the distance along the line between these."""
    between = second.corners[:, None] - first.corners[:, :, None]
    distance = np.linalg.norm(between, axis=3)
    m, count = distance.shape[0], distance.shape[2]
    i, j = np.divmod(distance.reshape(m, -1).argmin(axis=1), count)
    return i, j, separation(first, second, between[np.arange(m), i, j])


def edge_distances(polyhedra: Polyhedra, others: Polyhedra) -> tuple[np.ndarray, np.ndarray]:
    """(m, e, c) distances of the corners of the others from edges, infinite beside their ends, and
    (m, e, c, 3) vectors of these distances."""
    starts = polyhedra.corners[:, polyhedra.form.edges[:, 0]]
    relative = others.corners[:, None] - starts[:, :, None]
    lines = polyhedra.lines[:, :, None]
    fraction = (relative * lines).sum(axis=3) / (lines * lines).sum(axis=3)
    vectors = relative - fraction[..., None] * lines
    beside = (fraction > 0) & (fraction < 1)
    return np.where(beside, np.linalg.norm(vectors, axis=3), np.inf), vectors


def separation(first: Polyhedra, second: Polyhedra, along: np.ndarray) -> np.ndarray:
    """(m,) distances along vectors (m, 3); −∞ for a zero vector."""
    length = np.linalg.norm(along, axis=1)
    apart = length > 0
    unit = along / np.where(apart, length, 1.0)[:, None]
    i, j = ((p.corners @ unit[:, :, None])[..., 0] for p in (first, second))
    return np.where(apart, j.min(axis=1) - i.max(axis=1), -np.inf)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
