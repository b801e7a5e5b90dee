"""Meshes of all cells on the unit square and cube, for tests."""

from __future__ import annotations

from itertools import combinations, permutations

import casadi as ca
import numpy as np

from dalembert.elements.fem.cells import Cell
from dalembert.elements.fem.reference_cells import REFERENCE_CELLS
from dalembert.model.meshes.generators import box_mesh, rectangle_mesh

CORNERS = {
    "triangle6": "triangle",
    "quad8": "quad",
    "tetra10": "tetra",
    "hexahedron20": "hexahedron",
}

PLACES = {
    (0, 1): [(0, 0, 0)],
    (1, 2): [(0, 0, 0), (1, 0, 0)],
    (2, 3): [(0, 0, 0), (1, 0, 0), (0, 1, 0)],
    (2, 4): [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
    (3, 4): [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    (3, 8): [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))],
}
"""Dimension and number of corners of a cell → where they are."""


def unit_mesh(shape: str, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, d) and cells of the unit square or cube, ``count`` divisions of each edge."""
    plain = CORNERS.get(shape, shape)
    if plain in ("triangle", "quad"):
        points, cells = rectangle_mesh((1, 1), (count, count), plain)
    else:
        points, cells = box_mesh((1, 1, 1), (count, count, count))
        if plain == "tetra":
            cells = np.concatenate([cells[:, corners] for corners in _tetrahedra()])
    return (points, cells) if plain == shape else with_middles(shape, points, cells)


def with_middles(shape: str, points: np.ndarray, cells: np.ndarray):
    """A quadratic mesh with straight edges from one of corners."""
    edges = np.sort(np.stack([cells[:, [i, j]] for i, j in middles_of(shape)], axis=1), axis=2)
    expected, place = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
    more = len(points) + place.reshape(edges.shape[:2])
    return np.vstack([points, points[expected].mean(axis=1)]), np.hstack([cells, more])


def middles_of(shape: str) -> list[tuple[int, int]]:
    """Corners between which the further nodes lie."""
    nodes = np.array(REFERENCE_CELLS[shape].nodes)
    corners = len(REFERENCE_CELLS[CORNERS[shape]].nodes)
    pairs = list(combinations(range(corners), 2))
    edges = []
    for middle in nodes[corners:]:  # diagonals meet in centres, which are no nodes
        edges += [(i, j) for i, j in pairs if np.allclose((nodes[i] + nodes[j]) / 2, middle)]
    return edges


def _tetrahedra() -> list[list[int]]:
    """Six tetrahedra of a hexahedron, along its diagonal (Kuhn)."""
    numbers = {(0, 0, 0): 0, (1, 0, 0): 1, (1, 1, 0): 2, (0, 1, 0): 3}
    numbers |= {(x, y, 1): k + 4 for (x, y, _), k in list(numbers.items())}
    results = []
    for order in permutations(range(3)):
        steps = np.cumsum(np.vstack([np.zeros(3, int), np.eye(3, dtype=int)[list(order)]]), axis=0)
        cell = [numbers[tuple(int(c) for c in step)] for step in steps]
        odd = np.linalg.det(np.eye(3)[list(order)]) < 0
        results.append([cell[0], cell[2], cell[1], cell[3]] if odd else cell)
    return results


def shape_values(shape: str, natural) -> np.ndarray:
    """(nodes,) shape functions at natural coordinates."""
    cell = REFERENCE_CELLS[shape]
    place = ca.SX.sym("place", cell.dimension)
    function = ca.Function("shapes", [place], [ca.densify(cell.shape_functions(place))])
    return np.array(function(natural)).ravel()


def places_of(cell: Cell) -> np.ndarray:
    """(nodes, 3) corners somewhat out of place, and middles of edges."""
    corners = np.array(PLACES[cell.dimension, cell.corners], dtype=float)
    computed = np.zeros((cell.nodes, 3))
    computed[: cell.corners] = corners + np.random.default_rng(1).uniform(-0.1, 0.1, corners.shape)
    for outline in cell.faces if cell.nodes > cell.corners else ():
        ends, middles = list(outline[::2]), list(outline[1::2])
        computed[middles] = (computed[ends] + computed[np.roll(ends, -1)]) / 2
    return computed
