"""Cells of meshes by name: dimension, faces, edges, and node order of the reversed cell.

Nodes are numbered as in VTK and meshio: corners first, then midpoints of edges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Faces = tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class Cell:
    """A cell type.

    Attributes
    ----------
    dimension : dimension of the cell
    corners : number of corner nodes
    nodes : number of all nodes
    faces : outlines of its faces, node by node; one for a flat cell
    turned : node order of the same cell with opposite orientation
    """

    dimension: int
    corners: int
    nodes: int
    faces: Faces = ()
    turned: tuple[int, ...] = ()


_TRIANGLE, _QUAD = ((0, 1, 2),), ((0, 1, 2, 3),)
_TETRA = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
_HEXAHEDRON = (
    (0, 3, 2, 1),
    (4, 5, 6, 7),
    (0, 1, 5, 4),
    (1, 2, 6, 5),
    (2, 3, 7, 6),
    (3, 0, 4, 7),
)
_TETRA_MIDDLES = {(0, 1): 4, (1, 2): 5, (0, 2): 6, (0, 3): 7, (1, 3): 8, (2, 3): 9}
_HEXAHEDRON_MIDDLES = {
    **{(k, (k + 1) % 4): 8 + k for k in range(4)},
    **{(4 + k, 4 + (k + 1) % 4): 12 + k for k in range(4)},
    **{(k, 4 + k): 16 + k for k in range(4)},
}


def _with_middles(faces: Faces, middles: dict[tuple[int, int], int]) -> Faces:
    """The outlines with the midpoints of their edges."""
    midpoints = middles | {(j, i): m for (i, j), m in middles.items()}
    return tuple(
        tuple(n for i, j in zip(f, (*f[1:], f[0]), strict=True) for n in (i, midpoints[i, j]))
        for f in faces
    )


CELLS: dict[str, Cell] = {
    "vertex": Cell(0, 1, 1),
    "line": Cell(1, 2, 2),
    "line3": Cell(1, 2, 3),
    "triangle": Cell(2, 3, 3, _TRIANGLE, (0, 2, 1)),
    "triangle6": Cell(2, 3, 6, ((0, 3, 1, 4, 2, 5),), (0, 2, 1, 5, 4, 3)),
    "quad": Cell(2, 4, 4, _QUAD, (0, 3, 2, 1)),
    "quad8": Cell(2, 4, 8, ((0, 4, 1, 5, 2, 6, 3, 7),), (0, 3, 2, 1, 7, 6, 5, 4)),
    "quad9": Cell(2, 4, 9, ((0, 4, 1, 5, 2, 6, 3, 7),), (0, 3, 2, 1, 7, 6, 5, 4, 8)),
    "tetra": Cell(3, 4, 4, _TETRA, (0, 2, 1, 3)),
    "tetra10": Cell(
        3, 4, 10, _with_middles(_TETRA, _TETRA_MIDDLES), (0, 2, 1, 3, 6, 5, 4, 7, 9, 8)
    ),
    "hexahedron": Cell(3, 8, 8, _HEXAHEDRON, (4, 5, 6, 7, 0, 1, 2, 3)),
    "hexahedron20": Cell(
        3,
        8,
        20,
        _with_middles(_HEXAHEDRON, _HEXAHEDRON_MIDDLES),
        (4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19),
    ),
}


def cell_name(nodes: int, dimension: int) -> str | None:
    """The cell of a dimension with a number of nodes, or the line with two."""
    fitting = [
        name
        for name, cell in CELLS.items()
        if cell.nodes == nodes and (cell.dimension == dimension or nodes == 2)
    ]
    return fitting[0] if fitting else None


def oriented(name: str, points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """The cells with node orders of positive area or volume.

    Parameters
    ----------
    points : (count, d) [m]; cells of fewer than ``d`` dimensions have no orientation and are
        unchanged, as are those whose coordinates are formulas
    cells : (cells, nodes)
    """
    cell = CELLS[name]
    if cell.dimension != points.shape[1] or not cell.turned or points.dtype == object:
        return cells
    corner = points[cells]
    if cell.dimension == 2:
        first, last = corner[:, 1] - corner[:, 0], corner[:, cell.corners - 1] - corner[:, 0]
        size = first[:, 0] * last[:, 1] - first[:, 1] * last[:, 0]
    else:
        third = 3 if cell.corners == 4 else 4
        edges = [corner[:, k] - corner[:, 0] for k in (1, 2 if third == 3 else 3, third)]
        size = np.einsum("ij,ij->i", np.cross(edges[0], edges[1]), edges[2])
    result = cells.copy()
    result[size < 0] = cells[size < 0][:, cell.turned]
    return result


def facets(name: str) -> tuple[str, tuple[tuple[int, ...], ...]]:
    """Cell name of the edges of a flat cell or faces of a solid one, and their nodes.

    Edges have the cell on their left, faces are counter-clockwise from outside; nodes are in the
    order of VTK.
    """
    cell = CELLS[name]
    quadratic = cell.nodes > cell.corners
    if cell.dimension == 2:
        outline = cell.faces[0]
        step = 2 if quadratic else 1
        edges = []
        for k in range(0, len(outline), step):
            end = outline[(k + step) % len(outline)]
            edges.append((outline[k], end, outline[k + 1]) if quadratic else (outline[k], end))
        return ("line3" if quadratic else "line"), tuple(edges)
    faces = tuple(f[::2] + f[1::2] if quadratic else f for f in cell.faces)
    corners = len(cell.faces[0]) // (2 if quadratic else 1)
    shape = "triangle" if corners == 3 else "quad"
    return shape + (str(2 * corners) if quadratic else ""), faces
