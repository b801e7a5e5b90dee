"""Near features of a cylinder and a rounded hull.

Each corner, edge and face of the hull is a part of it, which must not enter the cylinder, and each
point of a rim must not enter the hull. Features that touch have a common normal. Sharp ones, whose
distance may be negative in several directions, count if it is nearly the largest (separating axes,
Gottschalk, Lin & Manocha 1996).
"""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.gaps.cylinders.cylinders import SECTORS, Cylinders
from dalembert.analysis.nonsmooth.gaps.cylinders.rim_candidates import (
    MEET,
    Evaluate,
    evaluated,
    on_lines,
    rims_at_lines,
    some_rows,
)
from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps.hulls.face_contacts import depth_in_face
from dalembert.analysis.nonsmooth.gaps.hulls.planar_features import Rows
from dalembert.analysis.nonsmooth.gaps.hulls.polyhedra import PARALLEL_EDGES, Polyhedra
from dalembert.elements.contact.hull import MARKS

FLAT = 1e-3
"""Difference of the separations of features that touch together, by the size of the shapes."""
ROUNDING = 1e-7
"""Error of a separation, by the size of the shapes."""
TILT = 0.05
"""Sine of the angle of an end and a plane within which the end may stand on it."""
AGAINST = 0.5
"""Sine of the angle by which a shape may lie against the normal of a contact."""
CLOSER = 1e-10
"""Difference of heights of the lowest rim and other features, by the size of the shapes."""
ON_EDGE = 1e-9
"""Part of a line beyond its ends that belongs to it."""


def cylinder_features(
    cylinders: Cylinders, others: Polyhedra, rounded: np.ndarray, evaluate: Evaluate
) -> list[Rows]:
    """Features of m cylinders and hulls that touch first.

    Parameters
    ----------
    cylinders, others : m shapes; in rows the cylinders are first
    rounded : (m,) whether the hull has a radius
    evaluate : gaps of rows
    """
    corners, beside, nearest = _corners(cylinders, others, rounded)
    if not others.form.edges.size:
        return corners
    lines = [*_rims(cylinders, others, rounded), *_sides(cylinders, others)]
    if not others.form.has_faces:
        return [*corners, *(_at_capsules(rows, cylinders, others, evaluate) for rows in lines)]
    size = np.ptp(others.corners, axis=1).max(axis=1) + 2 * np.maximum(
        cylinders.half, cylinders.radii
    )
    gaps, faces = [], _faces(cylinders, others)
    best = np.max([beside, _ends(cylinders, others), faces.max(axis=1)], axis=0)
    for k, candidates in enumerate(lines):
        rows, gap, normal = _meeting(candidates, others, size, evaluate)
        lines[k], separation = rows, _separation(rows, normal, cylinders, others)
        np.maximum.at(best, rows[1], separation)
        gaps.append(np.where(gap - separation <= FLAT * size[rows[1]], gap, -np.inf))
    largest = best - ROUNDING * size
    for k, (rows, gap) in enumerate(zip(lines, gaps, strict=True)):
        near = gap >= largest[rows[1]]
        lines[k] = some_rows(rows, near)
        np.minimum.at(nearest, rows[1][near], gap[near])
    pair = np.flatnonzero(faces.max(axis=1) >= best - FLAT * size)
    f = faces[pair].argmax(axis=1)
    lowest = np.where(faces[pair, f] >= largest[pair], nearest[pair] - CLOSER * size[pair], -np.inf)
    over = _over_faces(cylinders.some(pair), others.some(pair), f, lowest)
    return [*corners, *lines, *((feature, pair[row], s, a, b) for feature, row, s, a, b in over)]


# parts of the hull ----------------------------------------------------------------------------
def _corners(
    cylinders: Cylinders, others: Polyhedra, rounded: np.ndarray
) -> tuple[list[Rows], np.ndarray, np.ndarray]:
    """Corners over an end, beside the round side or near a rim; the largest separation along a
    normal of the round side through a corner; the smallest gap of the corners."""
    over, beside, end = cylinders.depths(others.corners)
    outside = (over > 0) & (beside > 0) & rounded[:, None]
    on_side = ~outside & (beside > over) & (beside > -0.999 * cylinders.radii[:, None])
    axis = cylinders.outward[:, 0]
    relative = others.corners - cylinders.center[:, None]
    across = relative - (relative @ axis[:, :, None]) * axis[:, None]
    length = np.linalg.norm(across, axis=2, keepdims=True)
    radial = np.divide(across, length, out=np.zeros_like(across), where=length > 0)
    along = np.take_along_axis(cylinders.outward, end[..., None], axis=1)
    rows, nearest = [], np.full(over.shape[0], np.inf)
    for feature, selected, own, normals in (
        (Feature.CAP, ~outside & ~on_side, end, along),
        (Feature.EDGE, on_side, 0 * end, radial),
        (Feature.RIM_CORNER, outside, end, np.where((over > beside)[..., None], along, radial)),
    ):
        pair, corner = np.nonzero(selected & _facing(others, normals))
        gap = np.maximum(over, beside)[pair, corner]
        np.minimum.at(nearest, pair, gap)
        none = np.zeros(pair.size, dtype=bool)
        rows.append((feature, pair, none, own[pair, corner], corner))
    separation = (radial @ np.swapaxes(across, 1, 2)).min(axis=2).max(axis=1) - cylinders.radii
    return rows, separation, nearest


def _facing(others: Polyhedra, normals: np.ndarray) -> np.ndarray:
    """(m, k) mask of corners whose hull does not lie against the normals (m, k, 3) there."""
    between = others.corners[:, None] - others.corners[:, :, None]
    height = (between * normals[:, :, None]).sum(axis=3)
    facing: np.ndarray = (height >= -AGAINST * np.linalg.norm(between, axis=3)).all(axis=2)
    return facing


def _rims(cylinders: Cylinders, others: Polyhedra, rounded: np.ndarray) -> list[Rows]:
    """Rims that may touch edges."""
    starts = others.corners[:, others.form.edges[:, 0]]
    pair, rim, edge = rims_at_lines(cylinders, starts, others.lines)
    rows = []
    for feature, kind in ((Feature.RIM_LINE, rounded), (Feature.RIM_EDGE, ~rounded)):
        own = kind[pair]
        none = np.zeros(int(own.sum()), dtype=bool)
        rows.append((feature, pair[own], none, rim[own], edge[own]))
    return rows


def _sides(cylinders: Cylinders, others: Polyhedra) -> list[Rows]:
    """Edges that cross the axis between its ends."""
    axis, count = cylinders.corners[:, 1] - cylinders.corners[:, 0], len(others.form.edges)
    starts, lines = others.corners[:, others.form.edges[:, 0]], others.lines
    across = np.cross(axis[:, None], lines)
    square = (across**2).sum(axis=2)
    limit = PARALLEL_EDGES * (2 * cylinders.half)[:, None] * np.linalg.norm(lines, axis=2)
    crossing = square > limit**2
    divisor = np.where(crossing, square, 1.0)
    between = starts - cylinders.corners[:, None, 0]
    own = (np.cross(between, lines) * across).sum(axis=2) / divisor
    other = (np.cross(between, axis[:, None]) * across).sum(axis=2) / divisor
    for fraction in (own, other):
        crossing &= (fraction > -ON_EDGE) & (fraction < 1 + ON_EDGE)
    pair, edge = np.nonzero(crossing)
    if others.form.has_faces:  # away from the hull
        outward = starts[pair, edge] - others.corners[pair].mean(axis=1)
        reverse = (across[pair, edge] * outward).sum(axis=1) > 0
    else:
        reverse = (across * between).sum(axis=2)[pair, edge] < 0
    none = np.zeros(pair.size, dtype=bool)
    return [(Feature.EDGES, pair, none, 0 * pair, edge + reverse * count)]


def _meeting(
    candidates: Rows, others: Polyhedra, size: np.ndarray, evaluate: Evaluate
) -> tuple[Rows, np.ndarray, np.ndarray]:
    """The candidates, without rims that do not meet their edge between its ends; gaps and normals.

    The separation along a normal of both does not exclude these: where an end and a face are
    parallel, it is that of all crossings of the rim and the lines of the edges.
    """
    rows, gap, place, normal = evaluated(candidates, evaluate)
    feature, pair, _, _, edge = rows
    if feature not in (Feature.RIM_EDGE, Feature.RIM_LINE) or not pair.size:
        return rows, gap, normal
    starts, ends = (others.corners[pair, others.form.edges[edge, k]] for k in range(2))
    meets = between_ends(place, starts, ends)
    if feature is Feature.RIM_EDGE:
        foot = place + normal * (gap / 2)[:, None]
        meets &= on_lines(foot, starts, ends - starts) <= MEET * size[pair]
    return some_rows(rows, meets), gap[meets], normal[meets]


def _at_capsules(rows: Rows, cylinders: Cylinders, others: Polyhedra, evaluate: Evaluate) -> Rows:
    """The rows, without rims whose nearest point of the line is not between its ends."""
    rows, gap, place, normal = evaluated(rows, evaluate)
    feature, pair, _, rim, _ = rows
    if feature is not Feature.RIM_LINE:
        return rows
    point = place - normal * (gap / 2)[:, None]
    outside = cylinders.some(pair).outside(rim // SECTORS, point, normal) >= -AGAINST
    ends = others.corners[pair, 0], others.corners[pair, 1]
    return some_rows(rows, outside & between_ends(place, *ends))


def between_ends(places: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Mask of places (n, 3) between the ends of lines."""
    line = ends - starts
    fraction = ((places - starts) * line).sum(axis=1) / (line * line).sum(axis=1)
    inside: np.ndarray = (fraction > -ON_EDGE) & (fraction < 1 + ON_EDGE)
    return inside


# separations ----------------------------------------------------------------------------------
def _separation(
    rows: Rows, normal: np.ndarray, cylinders: Cylinders, others: Polyhedra
) -> np.ndarray:
    """(n,) distances of the shapes of rows along normals (n, 3)."""
    corners, own = others.corners[rows[1]], cylinders.some(rows[1])
    distance: np.ndarray = (corners @ normal[:, :, None])[..., 0].min(axis=1)
    return distance - own.farthest(normal[:, None])[:, 0]


def _ends(cylinders: Cylinders, others: Polyhedra) -> np.ndarray:
    """(m,) larger separation along the axis."""
    relative = others.corners - cylinders.center[:, None]
    height = (relative @ cylinders.outward[:, 0, :, None])[..., 0]
    separation: np.ndarray = np.maximum(height.min(axis=1), -height.max(axis=1)) - cylinders.half
    return separation


def _faces(cylinders: Cylinders, others: Polyhedra) -> np.ndarray:
    """(m, f) smallest heights of the cylinder over the faces."""
    normals = others.normals
    starts = others.corners[:, others.form.loops[:, 0]]
    heights: np.ndarray = -cylinders.farthest(-normals) - (normals * starts).sum(axis=2)
    return heights


def _over_faces(
    cylinders: Cylinders, others: Polyhedra, f: np.ndarray, lower: np.ndarray
) -> list[Rows]:
    """Rims and ends over face ``f`` of each hull; the lowest rim, beside the face, where it is
    lower than all other features, whose heights are ``lower`` (m,)."""
    if not f.size:
        return []
    every = np.arange(f.size)
    normal = others.normals[every, f]
    lowest, start = cylinders.lowest(normal), others.corners[every, others.form.loops[f, 0]]
    inside = depth_in_face(others, f, lowest) >= -ON_EDGE
    heights = ((lowest - start[:, None]) @ normal[:, :, None])[..., 0]
    nearest = np.minimum(lower, np.where(inside, heights, np.inf).min(axis=1))
    first = np.flatnonzero(nearest > heights.min(axis=1))
    inside[first, heights[first].argmin(axis=1)] = True
    row, end = np.nonzero(inside)
    rows = [(Feature.FACE_RIM, row, np.ones(row.size, dtype=bool), f[row], end)]
    facing = (cylinders.outward @ normal[:, :, None])[..., 0]
    row, end = np.nonzero(facing < -np.sqrt(1 - TILT**2))
    over = depth_in_face(others.some(row), f[row], cylinders.marks[row, end]) >= -ON_EDGE
    k, mark = np.nonzero(over)
    corner = 2 + end[k] * MARKS + mark
    rows.append((Feature.FACE, row[k], np.ones(k.size, dtype=bool), f[row[k]], corner))
    return rows
