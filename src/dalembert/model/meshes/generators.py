"""Regular meshes of lines, rectangles and boxes, as points and cells."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dalembert.budget import check_budget, numeral
from dalembert.elements.fem.cells import CELLS
from dalembert.errors import ModelError
from dalembert.options import is_number
from dalembert.text.arguments import check_arguments

CELL = 1000
"""Minimum memory of a cell with its nodes and its element [bytes]."""

Mesh = tuple[np.ndarray, np.ndarray]


@check_arguments
def line_mesh(start: Sequence[float], end: Sequence[float], count: int) -> Mesh:
    """A straight line divided into ``count`` lines.

    Parameters
    ----------
    start, end : (d,) places [m]
    count : number of lines

    Returns
    -------
    points (count + 1, d), cells (count, 2)

    Raises
    ------
    ModelError
        The count is not a positive whole number.

    Examples
    --------
    >>> from dalembert import structures
    >>> points, cells = structures.line_mesh((0, 0), (3, 0), 3)
    >>> points.tolist()
    [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]
    >>> cells.tolist()
    [[0, 1], [1, 2], [2, 3]]
    """
    (count,) = _counts((count,), 1)
    points = np.linspace(np.atleast_1d(start), np.atleast_1d(end), count + 1)
    return points.astype(float), np.column_stack([np.arange(count), np.arange(1, count + 1)])


@check_arguments
def rectangle_mesh(size: Sequence[float], counts: Sequence[int], kind: str = "quad") -> Mesh:
    """A rectangle from the origin, divided evenly.

    Parameters
    ----------
    size : (2,) lengths along x and y [m]
    counts : (2,) number of quadrilaterals along x and y
    kind : ``"quad"``, or ``"triangle"`` for two in each quadrilateral; ``"quad8"``, ``"triangle6"``
        with nodes in the middles of the edges

    Returns
    -------
    points (nodes, 2), cells (cells, nodes of one)

    Raises
    ------
    ModelError
        Another kind, or numbers that make no mesh.

    Examples
    --------
    >>> from dalembert import structures
    >>> points, cells = structures.rectangle_mesh((2, 1), (4, 2))
    >>> points.shape, cells.shape
    ((15, 2), (8, 4))
    >>> structures.rectangle_mesh((2, 1), (4, 2), "triangle6")[1].shape
    (16, 6)
    """
    points, (corner, right, far, up) = _grid(size, counts, 2)
    if kind in ("quad", "quad8"):
        cells = np.column_stack([corner, right, far, up])
    elif kind in ("triangle", "triangle6"):
        below, above = np.column_stack([corner, right, far]), np.column_stack([corner, far, up])
        cells = np.stack([below, above], axis=1).reshape(-1, 3)
    else:
        known = "quad, triangle, quad8, triangle6"
        raise ModelError(f"rectangle_mesh: unknown kind {kind!r}; known: {known}")
    return _of_kind(points, cells, kind)


@check_arguments
def box_mesh(size: Sequence[float], counts: Sequence[int], kind: str = "hexahedron") -> Mesh:
    """A box from the origin, divided evenly into hexahedra.

    Parameters
    ----------
    size : (3,) lengths along x, y and z [m]
    counts : (3,) number of hexahedra along each
    kind : ``"hexahedron"``, or ``"hexahedron20"`` with nodes in the middles of the edges

    Returns
    -------
    points (nodes, 3), cells (nx ny nz, nodes of one)

    Raises
    ------
    ModelError
        Another kind, or numbers that make no mesh.

    Examples
    --------
    >>> from dalembert import structures
    >>> points, cells = structures.box_mesh((1, 1, 1), (2, 3, 4))
    >>> points.shape, cells.shape
    ((60, 3), (24, 8))
    >>> structures.box_mesh((1, 1, 1), (1, 1, 1), "hexahedron20")[1].shape
    (1, 20)
    """
    if kind not in ("hexahedron", "hexahedron20"):
        raise ModelError(f"box_mesh: unknown kind {kind!r}; known: hexahedron, hexahedron20")
    points, corners = _grid(size, counts, 3)
    return _of_kind(points, np.column_stack(corners), kind)


def _of_kind(points: np.ndarray, cells: np.ndarray, kind: str) -> Mesh:
    """The mesh with midside nodes if the kind has them."""
    cell = CELLS[kind]
    if cell.nodes == cell.corners:
        return points, cells
    middles = {
        f[k]: (f[k - 1], f[(k + 1) % len(f)]) for f in cell.faces for k in range(1, len(f), 2)
    }
    ends = np.stack([cells[:, middles[m]] for m in range(cell.corners, cell.nodes)], axis=1)
    edges, where = np.unique(np.sort(ends, axis=2).reshape(-1, 2), axis=0, return_inverse=True)
    numbers = len(points) + where.reshape(len(cells), -1)
    return np.vstack([points, points[edges].mean(axis=1)]), np.hstack([cells, numbers])


def _grid(size: Sequence[float], counts: Sequence[int], d: int) -> tuple[np.ndarray, list]:
    """Points, x fastest, and the corners of all cells: around the lower face, then the upper."""
    n = _counts(counts, d)
    if len(size) != d or not all(is_number(length) and length > 0 for length in size):
        raise ModelError(f"a mesh needs {d} positive lengths, got {size!r}")
    axes = [np.linspace(0.0, length, k + 1) for length, k in zip(size, n, strict=True)]
    grid = np.meshgrid(*axes, indexing="ij")
    points = np.column_stack([axis.ravel(order="F") for axis in grid])
    numbers = np.arange(len(points)).reshape([k + 1 for k in n], order="F")

    def corner(*shift: int) -> np.ndarray:
        part = tuple(slice(s, s + k) for s, k in zip(shift, n, strict=True))
        return numbers[part].ravel(order="F")

    around = ((0, 0), (1, 0), (1, 1), (0, 1))
    if d == 2:
        return points, [corner(*shift) for shift in around]
    return points, [corner(*shift, z) for z in (0, 1) for shift in around]


def _counts(counts: Sequence[int], d: int) -> list[int]:
    values = list(counts) if isinstance(counts, (tuple, list, np.ndarray)) else []
    whole = all(isinstance(k, (int, np.integer)) and k > 0 for k in values)
    if len(values) != d or not whole:
        raise ModelError(f"a mesh needs {d} positive whole number(s) of cells, got {counts!r}")
    cells = math.prod(int(k) for k in counts)
    cure = "divide it into fewer cells"
    check_budget(f"a mesh of {numeral(cells)} cells", memory=CELL * cells, cure=cure)
    return [int(k) for k in counts]
