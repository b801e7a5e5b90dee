"""Features of a terrain near points, balls and the rims of cylinders.

A point touches the triangle below it, and those beyond valleys. A ball touches the nearest points
of triangles, ridges and peaks: a point of an edge, or a vertex, if it is that of all triangles
there.
"""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.gaps.cylinders.cylinder_features import TILT
from dalembert.analysis.nonsmooth.gaps.cylinders.cylinders import Cylinders
from dalembert.analysis.nonsmooth.gaps.terrain.terrain import RIDGE, Terrain

Touching = tuple[np.ndarray, np.ndarray]
"""Numbers of places, and of triangles, edges or vertices."""
VALLEY = 1e-9
"""Difference of heights over two planes that are not the same, and distance of two nearest points
that are not the same, by the size of a cell."""
OFFSET = 0.37
"""Shift of nearest points before they are rounded down, as many are multiples of the size of a cell
[-]."""


def triangles_below(terrain: Terrain, places: np.ndarray, reach: float) -> Touching:
    """Triangles that points (k, 3) touch."""
    own, inside = terrain.below(places)
    number, triangle = terrain.triangles_near(places, np.full(len(places), reach))
    return _valleys(terrain, number, triangle, places[number], own[number], inside[number])


def _valleys(
    terrain: Terrain,
    number: np.ndarray,
    triangle: np.ndarray,
    places: np.ndarray,
    own: np.ndarray,
    inside: np.ndarray,
) -> Touching:
    """The triangles below places, and those whose planes are still lower there."""
    lower = terrain.height(places, triangle) - terrain.height(places, own)
    touching = inside & ((triangle == own) | (lower > VALLEY * terrain.lengths.max()))
    return number[touching], triangle[touching]


def surface_near_balls(
    terrain: Terrain, centers: np.ndarray, radii: np.ndarray, reach: float
) -> tuple[Touching, Touching, Touching]:
    """Triangles, edges and vertices that balls (k, 3) touch."""
    form = terrain.form
    number, triangle = terrain.triangles_near(centers, radii + reach)
    own, inside = terrain.below(centers)
    sunk = inside & (terrain.height(centers, own) <= 0)
    corners = terrain.places[form.triangles[triangle]]
    over, edge, vertex = _nearest(corners, centers[number], terrain.normals[triangle])
    heights = terrain.height(centers[number], triangle)
    beside = ~over & ~sunk[number]
    over &= ~sunk[number] & (heights > 0)  # not the far side of a peak
    over[over] = _single(terrain, number[over], centers[number[over]], triangle[over])
    on_edge = beside & (vertex < 0)
    edges, row, count = np.unique(
        np.stack([number, form.edge_of[triangle, edge]])[:, on_edge],
        axis=1,
        return_inverse=True,
        return_counts=True,
    )
    sides = (form.beside[edges[1]] >= 0).sum(axis=1)
    single = ((count < sides) & (terrain.bends[edges[1]] < -RIDGE))[row.ravel()]  # beyond a valley
    lowest = np.full(len(centers), np.inf)
    np.minimum.at(lowest, number[over], heights[over])
    valley = np.flatnonzero(on_edge)[single]
    valley = valley[heights[valley] >= lowest[number[valley]]]
    corner = form.triangles[triangle, np.maximum(vertex, 0)]
    peaks, shared = np.unique(
        np.stack([number, corner])[:, beside & (vertex >= 0)], axis=1, return_counts=True
    )
    faces = [np.stack([number, triangle])[:, selected] for selected in (over, valley)]
    faces.append(np.stack([np.flatnonzero(sunk), own[sunk]]))
    ridges, peaks = edges[:, count == sides], peaks[:, shared == form.triangle_counts[peaks[1]]]
    balls, planes = np.hstack(faces)
    return (balls, planes), (ridges[0], ridges[1]), (peaks[0], peaks[1])


def _single(
    terrain: Terrain, number: np.ndarray, centers: np.ndarray, triangle: np.ndarray
) -> np.ndarray:
    """(k,) mask of one triangle for each nearest point of a ball; triangles of one plane share
    those on their edges."""
    normal, corner = terrain.normals[triangle], terrain.places[terrain.form.triangles[triangle, 0]]
    distance = ((centers - corner) * normal).sum(axis=1)
    nearest = (centers - distance[:, None] * normal) / (VALLEY * terrain.lengths.max())
    places = np.column_stack([number, np.floor(nearest + OFFSET)])
    single = np.zeros(number.size, dtype=bool)
    single[np.unique(places, axis=0, return_index=True)[1]] = True
    return single


def _nearest(
    corners: np.ndarray, places: np.ndarray, normals: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Whether the nearest point of triangles (k, 3, 3) is inside, else its edge, else its vertex or
    −1."""
    sides = np.roll(corners, -1, axis=1) - corners
    relative = places[:, None] - corners
    inward = np.cross(normals[:, None], sides)
    inside = ((relative * inward).sum(axis=2) >= 0).all(axis=1)
    fraction = np.clip((relative * sides).sum(axis=2) / (sides**2).sum(axis=2), 0.0, 1.0)
    distance = np.linalg.norm(relative - fraction[..., None] * sides, axis=2)
    edge, rows = distance.argmin(axis=1), np.arange(len(corners))
    along = fraction[rows, edge]
    vertex = np.where(along <= 0, edge, np.where(along >= 1, (edge + 1) % 3, -1))
    return inside, edge, vertex


def triangles_below_rims(terrain: Terrain, cylinders: Cylinders, reach: float) -> list[Touching]:
    """Triangles that the lowest points of both rims touch, and those that points on the rims of
    ends touch that stand on them: numbers of the rims, or of the points, and of the triangles."""
    m = cylinders.radii.size
    number, triangle = terrain.triangles_near(
        cylinders.ends.reshape(-1, 3), np.repeat(cylinders.radii, 2) + reach
    )
    owner, end = np.divmod(number, 2)
    normal = terrain.normals[triangle]
    lowest = cylinders.some(owner).lowest(normal)[np.arange(number.size), end]
    own, inside = terrain.below(lowest)
    apart = np.abs(terrain.coordinates(lowest) - terrain.coordinates(_middles(terrain, triangle)))
    near = (apart <= 0.5 + reach / terrain.lengths).all(axis=1) & inside
    rims = _valleys(terrain, number, triangle, lowest, own, near)
    marks = cylinders.marks.reshape(-1, 3)
    mark, under = triangles_below(terrain, marks, reach)
    owner, k = np.divmod(mark, marks.shape[0] // max(m, 1))
    facing = cylinders.outward[owner, k // (marks.shape[0] // max(2 * m, 1))]
    standing = (facing * terrain.normals[under]).sum(axis=1) < -np.sqrt(1 - TILT**2)
    return [rims, (mark[standing], under[standing])]


def _middles(terrain: Terrain, triangles: np.ndarray) -> np.ndarray:
    """(k, 3) middles of the cells of triangles."""
    middles: np.ndarray = terrain.places[terrain.form.triangles[triangles - triangles % 2]][
        :, [0, 2]
    ].mean(axis=1)
    return middles
