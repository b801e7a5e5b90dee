"""Peaks and ridges of a terrain near the faces, edges and round sides of bodies."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.gaps.cylinders.cylinders import Cylinders
from dalembert.analysis.nonsmooth.gaps.cylinders.rim_candidates import rims_at_lines
from dalembert.analysis.nonsmooth.gaps.hulls.polyhedra import PARALLEL_EDGES, Polyhedra
from dalembert.analysis.nonsmooth.gaps.terrain.terrain import RIDGE, Terrain

OUTSIDE = 1e-6
"""Sine of the angle by which a surface or a body may lie beyond the tangent plane of a contact."""
UPWARD = 0.05
"""Lower limit of the upward component of the normals of contacts at the border, which has no sides
[-]."""

Touching = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Numbers of the bodies, of their features, and of vertices or edges."""


def vertices_near(
    terrain: Terrain, low: np.ndarray, high: np.ndarray, lowest: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of boxes (k, 2) in cells, and vertices in them not beneath ``lowest`` (k,)."""
    number, i, j = terrain.cells_near(low, high + 1, more=1)
    vertex = i * terrain.form.grid[1] + j
    heights = (terrain.places[vertex] - terrain.corners[0]) @ terrain.up
    near = heights >= lowest[number]
    return number[near], vertex[near]


def bounds(terrain: Terrain, corners: np.ndarray, margins: np.ndarray) -> tuple[np.ndarray, ...]:
    """Smallest and largest coordinates (m, 2) in cells, and lowest heights (m,), of corners
    (m, c, 3) with margins (m,)."""
    grid, wide = terrain.coordinates(corners), margins[:, None] / terrain.lengths
    heights = (corners - terrain.corners[0]) @ terrain.up
    return grid.min(axis=1) - wide, grid.max(axis=1) + wide, heights.min(axis=1) - margins


def peaks_under_faces(terrain: Terrain, polyhedra: Polyhedra, reach: float) -> Touching:
    """Peaks inside or beneath faces of m polyhedra."""
    number, vertex = _peaks(terrain, polyhedra.corners, np.full(len(polyhedra.corners), reach))
    places, normals = terrain.places[vertex], polyhedra.normals[number]
    starts = polyhedra.corners[number[:, None], polyhedra.form.loops[:, 0]]
    heights = ((places[:, None] - starts) * normals).sum(axis=2)
    face = heights.argmax(axis=1)
    rows = np.arange(face.size)
    near = heights[rows, face] <= reach
    near &= _is_below(terrain, vertex, normals[rows, face])
    return number[near], face[near], vertex[near]


def peaks_under_cylinders(
    terrain: Terrain, cylinders: Cylinders, reach: float
) -> tuple[Touching, Touching]:
    """Peaks under ends and round sides of m cylinders."""
    count = cylinders.radii.size
    number, vertex = _peaks(terrain, cylinders.corners, np.full(count, reach))
    some, places = cylinders.some(number), terrain.places[vertex]
    over, beside, end = (column[:, 0] for column in some.depths(places[:, None]))
    axis = some.outward[:, 0]
    relative = places - some.center
    across = relative - (relative * axis).sum(axis=1, keepdims=True) * axis
    length = np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
    rows = np.arange(number.size)
    sides = (beside > over) & (beside <= reach) & _is_below(terrain, vertex, across / length)
    ends = (over >= beside) & (over <= reach) & _is_below(terrain, vertex, some.outward[rows, end])
    none = np.zeros(number.size, dtype=int)
    return (
        (number[ends], end[ends], vertex[ends]),
        (number[sides], none[sides], vertex[sides]),
    )


def peaks_under_lines(
    terrain: Terrain, capsules: Polyhedra, radii: np.ndarray, reach: float
) -> Touching:
    """Peaks under the middle parts of m capsules."""
    number, vertex = _peaks(terrain, capsules.corners, radii + reach)
    start, line = capsules.corners[number, 0], capsules.lines[number, 0]
    relative = terrain.places[vertex] - start
    fraction = (relative * line).sum(axis=1) / (line * line).sum(axis=1)
    across = relative - fraction[:, None] * line
    length = np.maximum(np.linalg.norm(across, axis=1), 1e-300)
    near = (fraction > 0) & (fraction < 1) & (length <= radii[number] + reach)
    near &= _is_below(terrain, vertex, across / length[:, None])
    return number[near], np.zeros(int(near.sum()), dtype=int), vertex[near]


def ridges_across(
    terrain: Terrain, solids: Polyhedra | Cylinders, radii: np.ndarray, reach: float
) -> Touching:
    """Ridges that edges, or axes, of m solids cross: numbers of the solids, of the edges, reversed
    ones in the second half, and of the ridges."""
    if isinstance(solids, Cylinders):
        ends = solids.ends[:, None]
    else:
        ends = solids.corners[:, solids.form.edges]
    ridge, number = _ridges_near(terrain, solids.corners, radii + reach)
    count = ends.shape[1]
    line = (ends[:, :, 1] - ends[:, :, 0])[number]
    start = ends[number, :, 0]
    base = terrain.places[terrain.form.edges[ridge]]
    along = (base[:, 1] - base[:, 0])[:, None]
    between = start - base[:, None, 0]
    across = np.cross(along, line)
    square = (across**2).sum(axis=2)
    lengths = (along**2).sum(axis=2) * (line**2).sum(axis=2)
    crossing = square > PARALLEL_EDGES**2 * lengths
    square = np.where(crossing, square, 1.0)
    first = (np.cross(between, line) * across).sum(axis=2) / square
    second = (np.cross(between, along) * across).sum(axis=2) / square
    for fraction in (first, second):
        crossing &= (fraction > 0) & (fraction < 1)
    upward = np.where(across @ terrain.up < 0, -1.0, 1.0)
    normal = (upward / np.sqrt(square))[..., None] * across
    gap = (normal * between).sum(axis=2)
    crossing &= gap <= (radii + reach)[number][:, None]
    row, edge = np.nonzero(crossing)
    normal, ridges = normal[row, edge], ridge[row]
    near = _above_ridge(terrain, ridges, normal)
    places = start[row, edge] + second[row, edge, None] * line[row, edge]
    near &= ~_beyond(terrain, places, gap[row, edge], radii[number[row]])
    if not isinstance(solids, Cylinders):
        near &= _is_above(solids.corners[number[row]], start[row, edge], normal)
    row, edge = row[near], edge[near]
    reverse = upward[row, edge] < 0
    return number[row], edge + reverse * count, ridge[row]


def rims_across(terrain: Terrain, cylinders: Cylinders, reach: float) -> Touching:
    """Rims, with their sectors, that may touch ridges."""
    margins = np.full(cylinders.radii.size, reach)
    ridge, number = _ridges_near(terrain, cylinders.corners, margins)
    base = terrain.places[terrain.form.edges[ridge]]
    row, rim, _ = rims_at_lines(cylinders.some(number), base[:, :1], base[:, 1:] - base[:, :1])
    return number[row], rim, ridge[row]


def on_ridges(
    terrain: Terrain, ridge: np.ndarray, places: np.ndarray, normals: np.ndarray
) -> np.ndarray:
    """Mask of contact points between the ends of ridges, with downward normals (k, 3) there."""
    start, end = terrain.places[terrain.form.edges[ridge]].swapaxes(0, 1)
    line = end - start
    fraction = ((places - start) * line).sum(axis=1) / (line * line).sum(axis=1)
    return (fraction > 0) & (fraction < 1) & _above_ridge(terrain, ridge, -normals)


def _ridges_near(
    terrain: Terrain, corners: np.ndarray, margins: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Ridges near solids with corners (m, c, 3), and numbers of the solids."""
    wide = margins + _longest(terrain)
    number, vertex = vertices_near(terrain, *bounds(terrain, corners, wide))
    return _ridges(terrain, vertex, number)


def _longest(terrain: Terrain) -> float:
    return float(terrain.lengths.max())


def _peaks(
    terrain: Terrain, corners: np.ndarray, margins: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the solids, and peaks near them."""
    number, vertex = vertices_near(terrain, *bounds(terrain, corners, margins))
    peak = terrain.is_peak[vertex]
    return number[peak], vertex[peak]


def _ridges(
    terrain: Terrain, vertex: np.ndarray, number: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Ridges that begin at vertices, and numbers of their solids."""
    order = np.argsort(terrain.form.edges[:, 0], kind="stable")
    starts = np.searchsorted(terrain.form.edges[order, 0], [vertex, vertex + 1])
    counts = starts[1] - starts[0]
    within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    ridge = order[np.repeat(starts[0], counts) + within]
    number = np.repeat(number, counts)
    sharp = terrain.bends[ridge] > RIDGE
    return ridge[sharp], number[sharp]


def _is_below(terrain: Terrain, vertex: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Mask of vertices whose surface is beyond a tangent plane with a downward normal (k, 3)."""
    between = terrain.places[terrain.form.neighbours(vertex)] - terrain.places[vertex][:, None]
    lengths = np.linalg.norm(between, axis=2)
    height = (between * normals[:, None]).sum(axis=2)
    at_border = (lengths == 0).any(axis=1)  # without some of the neighbours
    upward = -normals @ terrain.up > np.where(at_border, UPWARD, 0.0)
    below: np.ndarray = (height >= -OUTSIDE * lengths).all(axis=1) & upward
    return below


def _above_ridge(terrain: Terrain, ridge: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Mask of ridges whose triangles are below a tangent plane with an upward normal (k, 3)."""
    start, sides = terrain.places[terrain.form.edges[ridge, 0]], terrain.form.beside[ridge]
    at_border = (sides < 0).any(axis=1)
    sides = np.where(sides < 0, sides[:, :1], sides)
    places = terrain.places[terrain.form.triangles[sides]]
    height = ((places - start[:, None, None]) * normals[:, None, None]).sum(axis=3)
    below: np.ndarray = (height <= OUTSIDE * _longest(terrain)).all(axis=(1, 2))
    return below & (~at_border | (normals @ terrain.up > UPWARD))


def _beyond(
    terrain: Terrain, places: np.ndarray, heights: np.ndarray, radii: np.ndarray
) -> np.ndarray:
    """Mask of places (k, 3) of edges or axes that are beneath a ridge along the normal of a contact
    but outside the material, as of a body on the other side of a fence."""
    own, inside = terrain.below(places)
    outside = ~inside | (terrain.height(places, own) > 0)
    beyond: np.ndarray = (heights < -radii) & outside
    return beyond


def _is_above(corners: np.ndarray, place: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Mask of solids whose corners (k, c, 3) are above a tangent plane through a place."""
    height = ((corners - place[:, None]) * normals[:, None]).sum(axis=2)
    above: np.ndarray = (height >= -OUTSIDE * np.ptp(corners, axis=1).max(axis=1)[:, None]).all(
        axis=1
    )
    return above
