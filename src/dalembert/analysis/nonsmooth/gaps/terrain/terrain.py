"""Terrain of triangles over a grid, in numbers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dalembert.elements.contact.hull import Hull

FRAME = 3
"""Number of corners before those of the surface: one of the grid, and its neighbours."""
RIDGE = 1e-9
"""Sine of the angle of two triangles that form a ridge or a valley."""


class TerrainForm:
    """Triangles and edges of a terrain, by numbers.

    Attributes
    ----------
    grid : numbers of rows and columns
    triangles, edges : (t, 3) and (e, 2) numbers of vertices
    edge_of : (t, 3) edge that begins at a vertex of a triangle
    beside : (e, 2) triangles on both sides of an edge, −1 beyond the border
    triangle_counts : (v,) number of triangles at a vertex
    """

    def __init__(self, hull: Hull):
        assert hull.grid is not None
        self.grid = hull.grid
        self.triangles = np.array(hull.faces) - FRAME
        self.edges = np.array(hull.edges) - FRAME
        count = self.grid[0] * self.grid[1]
        sides = np.stack([self.triangles, np.roll(self.triangles, -1, axis=1)], axis=2)
        first, last = sides.min(axis=2), sides.max(axis=2)
        numbers = self.edges.min(axis=1) * count + self.edges.max(axis=1)
        order = np.argsort(numbers)
        self.edge_of = order[np.searchsorted(numbers[order], first * count + last)]
        self.beside = np.full((len(self.edges), 2), -1)
        owner = np.repeat(np.arange(len(self.triangles)), 3)
        by_edge = np.argsort(self.edge_of.ravel(), kind="stable")
        edge = self.edge_of.ravel()[by_edge]
        second = np.concatenate([[False], edge[1:] == edge[:-1]]).astype(int)
        self.beside[edge, second] = owner[by_edge]
        self.triangle_counts = np.bincount(self.triangles.ravel(), minlength=count)

    def neighbours(self, vertices: np.ndarray) -> np.ndarray:
        """(k, 8) vertices about vertices; themselves beyond the border."""
        n, m = self.grid
        i, j = np.divmod(vertices, m)
        steps = [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if (a, b) != (0, 0)]
        rows = [(i + a, j + b) for a, b in steps]
        inside = [(r >= 0) & (r < n) & (c >= 0) & (c < m) for r, c in rows]
        numbers = [
            np.where(near, r * m + c, vertices) for near, (r, c) in zip(inside, rows, strict=True)
        ]
        return np.stack(numbers, axis=1)


@dataclass(frozen=True, eq=False)
class Terrain:
    """Corners (3 + v, 3) of a terrain: three of its grid, and the vertices."""

    corners: np.ndarray
    form: TerrainForm

    @cached_property
    def places(self) -> np.ndarray:
        """(v, 3) vertices."""
        return self.corners[FRAME:]

    @cached_property
    def cell(self) -> np.ndarray:
        """(2, 3) sides of a cell."""
        return self.corners[1:3] - self.corners[0]

    @cached_property
    def up(self) -> np.ndarray:
        """(3,) unit normal of the grid."""
        normal = np.cross(*self.cell)
        return normal / np.linalg.norm(normal)

    @cached_property
    def lengths(self) -> np.ndarray:
        """(2,) lengths of the sides of a cell."""
        return np.linalg.norm(self.cell, axis=1)

    @cached_property
    def normals(self) -> np.ndarray:
        """(t, 3) upward normals of the triangles."""
        a, b, c = (self.places[self.form.triangles[:, k]] for k in range(3))
        normals = np.cross(b - a, c - b)
        return normals / np.linalg.norm(normals, axis=1, keepdims=True)

    @cached_property
    def bends(self) -> np.ndarray:
        """(e,) sines of the angles of the triangles at edges: positive for ridges, one at the
        border."""
        first, second = self.form.beside.T
        ends = self.places[self.form.edges]
        across = self.places[self.form.triangles].mean(axis=1)[second] - ends[:, 0]
        across = across / np.linalg.norm(across, axis=1, keepdims=True)
        return np.where(second < 0, 1.0, -(self.normals[first] * across).sum(axis=1))

    @cached_property
    def is_peak(self) -> np.ndarray:
        """(v,) whether a ridge begins at a vertex."""
        peaks = np.zeros(len(self.places), dtype=bool)
        peaks[self.form.edges[self.bends > RIDGE]] = True
        return peaks

    @cached_property
    def top(self) -> float:
        """The largest height."""
        return float(((self.places - self.corners[0]) @ self.up).max())

    def coordinates(self, places: np.ndarray) -> np.ndarray:
        """(..., 2) positions on the grid, in cells."""
        relative: np.ndarray = (places - self.corners[0]) @ (
            self.cell / self.lengths[:, None] ** 2
        ).T
        return relative

    def height(self, places: np.ndarray, triangles: np.ndarray) -> np.ndarray:
        """Distances of places (..., 3) from the planes of triangles (...,)."""
        start = self.places[self.form.triangles[triangles, 0]]
        height: np.ndarray = ((places - start) * self.normals[triangles]).sum(axis=-1)
        return height

    def below(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(k,) triangles below places (k, 3), and whether these are above the rectangle."""
        n, m = self.form.grid
        grid = self.coordinates(places)
        cell = np.clip(np.floor(grid).astype(int), 0, [n - 2, m - 2])
        inside = np.all((grid >= 0) & (grid <= [n - 1, m - 1]), axis=1)
        u, v = (grid - cell).T
        return 2 * (cell[:, 0] * (m - 1) + cell[:, 1]) + (v > u), inside

    def cells_near(
        self, low: np.ndarray, high: np.ndarray, more: int = 0
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Numbers of the rectangles (k, 2) in cells, and rows and columns of cells that they
        overlap; vertices have one row and one column ``more`` than cells."""
        most = np.array(self.form.grid) - 2 + more
        first = np.maximum(np.floor(low).astype(int), 0)
        last = np.minimum(np.floor(high).astype(int), most)
        sizes = np.maximum(last - first + 1, 0)
        counts = sizes.prod(axis=1)
        number = np.repeat(np.arange(counts.size), counts)
        within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        i, j = np.divmod(within, np.maximum(sizes[number, 1], 1))
        return number, first[number, 0] + i, first[number, 1] + j

    def triangles_near(
        self, places: np.ndarray, reach: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of places (k, 3), and of triangles within a horizontal reach (k,)."""
        middle, wide = self.coordinates(places), reach[:, None] / self.lengths
        number, i, j = self.cells_near(middle - wide, middle + wide)
        cell = i * (self.form.grid[1] - 1) + j
        return np.repeat(number, 2), (2 * cell[:, None] + [0, 1]).ravel()
