"""Spatial solids that overlap a terrain so deeply at the start that no gap may be negative.

A point of a solid below the surface, and a point of the surface in a solid, are lower bounds of the
depth by their distances from the boundary of the other one.
"""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.cylinders.cylinders import Cylinders
from dalembert.analysis.nonsmooth.gaps.hulls.hull_gaps import HullGaps
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import Solids
from dalembert.analysis.nonsmooth.gaps.terrain.terrain import Terrain
from dalembert.analysis.nonsmooth.gaps.terrain.terrain_edges import bounds, vertices_near
from dalembert.analysis.nonsmooth.starts.overlapping_solids import Overlap
from dalembert.elements.contact.hull import MARKS

FRACTIONS = np.array([0.2, 0.4, 0.6, 0.8])
"""Points of edges that are tested, beside their ends [-]."""
SPOKES = np.array([[0, 1], *([e, 2 + MARKS * e + k] for e in (0, 1) for k in range(MARKS))])
"""Axis of a cylinder, and lines from the centres of its ends to their rims."""
EDGES = [4, 6, 7]
"""Neighbours of a vertex at the ends of the edges that begin there."""
CELLS = 2.0
"""Upper limit of a depth that is evaluated, by the diagonal of a cell [-]."""


def solids_in_terrain(
    source: HullGaps, configuration: Configuration, tolerances: np.ndarray
) -> Overlap | None:
    """The deepest overlap of solids and terrains; None without one.

    Parameters
    ----------
    source : gaps of spatial hulls
    configuration : Configuration
    tolerances : (s,) depth of an overlap of each shape that counts as rounded input [m]
    """
    geometry, deepest = source.geometry, None
    at = geometry.positions(configuration)
    solids = np.setdiff1d(np.arange(len(geometry.hulls)), geometry.terrains)
    for number in geometry.terrains:
        other = np.full(solids.size, number)
        touching = geometry.may_touch(other, solids) & ~geometry.compliant(other, solids)
        terrain = geometry.terrain(number, at)
        for hulls in geometry.equal_forms(solids[touching]):
            bodies = geometry.solids(hulls, at)
            depths = np.maximum(
                _below_surface(terrain, bodies), _in_solids(terrain, bodies, at.radii[hulls])
            )
            depths[depths <= np.minimum(tolerances[hulls], tolerances[number])] = 0.0
            k = int(depths.argmax())
            if depths[k] > (deepest[2] if deepest else 0.0):
                deepest = int(number), int(hulls[k]), float(depths[k])
    return deepest


def _below_surface(terrain: Terrain, solids: Solids) -> np.ndarray:
    """(m,) largest distances from the surface of points of m solids below it."""
    corners = solids.corners
    edges = SPOKES if isinstance(solids, Cylinders) else solids.form.edges
    start, line = corners[:, edges[:, 0], None], corners[:, edges[:, 1]] - corners[:, edges[:, 0]]
    between = start + FRACTIONS[:, None] * line[:, :, None]
    places = np.concatenate(
        [corners, between.reshape(len(corners), len(edges) * FRACTIONS.size, 3)], axis=1
    )
    count, places = places.shape[1], places.reshape(-1, 3)
    own, inside = terrain.below(places)
    sunk = np.flatnonzero(inside & (terrain.height(places, own) < 0))
    limit = CELLS * float(np.linalg.norm(terrain.lengths))
    depth = np.minimum(-terrain.height(places[sunk], own[sunk]), limit)
    grid, most = terrain.coordinates(places[sunk]), np.array(terrain.form.grid) - 1
    border = (np.minimum(grid, most - grid) * terrain.lengths).min(axis=1)
    depth = np.minimum(depth, border)
    row, triangle = terrain.triangles_near(places[sunk], depth)
    corner = terrain.places[terrain.form.triangles[triangle]]
    np.minimum.at(depth, row, _distances(corner, places[sunk][row], terrain.normals[triangle]))
    largest = np.zeros(len(corners))
    np.maximum.at(largest, sunk // count, depth)
    return largest


def _distances(corners: np.ndarray, places: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(k,) distances of places (k, 3) from triangles (k, 3, 3)."""
    sides = np.roll(corners, -1, axis=1) - corners
    relative = places[:, None] - corners
    inside = ((relative * np.cross(normals[:, None], sides)).sum(axis=2) >= 0).all(axis=1)
    fraction = np.clip((relative * sides).sum(axis=2) / (sides**2).sum(axis=2), 0.0, 1.0)
    beside = np.linalg.norm(relative - fraction[..., None] * sides, axis=2).min(axis=1)
    return np.where(inside, np.abs((relative[:, 0] * normals).sum(axis=1)), beside)


def _in_solids(terrain: Terrain, solids: Solids, radii: np.ndarray) -> np.ndarray:
    """(m,) largest depths of points of the edges of a terrain in m solids."""
    wide = radii + float(terrain.lengths.max())
    row, vertex = vertices_near(terrain, *bounds(terrain, solids.corners, wide))
    neighbours = terrain.places[terrain.form.neighbours(vertex)]
    start = terrain.places[vertex][:, None]
    lines = neighbours[:, EDGES, None] - start[:, None]
    between = start[:, None] + FRACTIONS[:, None] * lines
    places = np.concatenate(
        [start, between.reshape(row.size, len(EDGES) * FRACTIONS.size, 3)], axis=1
    )
    depths = _depths(solids, radii, row, places).max(axis=1, initial=0.0)
    largest = np.zeros(len(solids.corners))
    np.maximum.at(largest, row, depths)
    return largest


def _depths(solids: Solids, radii: np.ndarray, row: np.ndarray, places: np.ndarray) -> np.ndarray:
    """(n, k) depths of places (n, k, 3) in solids, negative outside."""
    if isinstance(solids, Cylinders):
        over, beside, _ = solids.some(row).depths(places)
        return -np.maximum(over, beside)
    if solids.form.has_faces:
        normals = solids.normals[row]
        starts = (normals * solids.corners[row[:, None], solids.form.loops[:, 0]]).sum(axis=2)
        heights = places @ np.swapaxes(normals, 1, 2) - starts[:, None]
        return radii[row, None] - heights.max(axis=2)
    start, line = solids.corners[row, 0], (solids.corners[:, -1] - solids.corners[:, 0])[row]
    square = np.maximum((line**2).sum(axis=1), np.finfo(float).tiny)
    relative = places - start[:, None]
    fraction = np.clip((relative * line[:, None]).sum(axis=2) / square[:, None], 0.0, 1.0)
    distance = np.linalg.norm(relative - fraction[..., None] * line[:, None], axis=2)
    return radii[row, None] - distance
