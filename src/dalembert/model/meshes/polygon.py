"""Mesh of a planar region with a polygonal outline and holes, whose dimensions may be formulas."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from dalembert.budget import check_budget, numeral
from dalembert.errors import ModelError
from dalembert.model.meshes.boundary import Boundary, Circle, Edge, Piece
from dalembert.model.meshes.mesh_data import MeshData
from dalembert.model.meshes.region import Region
from dalembert.model.meshes.triangulation import triangulate
from dalembert.options import is_number
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.text.arguments import check_arguments

CELL = 1000
"""Minimum memory of a triangle with its nodes and its element [bytes]."""


@check_arguments
def polygon_mesh(
    vertices: Sequence[Any],
    size: float,
    holes: Sequence[Any] = (),
    kind: str = "triangle6",
    parameters: Mapping[str, Parameter] | None = None,
) -> MeshData:
    """Triangles of a region with a polygonal outline and holes.

    Conforming Delaunay triangulation, refined until the edges have about the given length and the
    angles at least 20° where the corners have them (Ruppert 1995). Nodes between the corners of
    quadratic triangles lie on circular holes.

    Vertices, centres and radii may be formulas of parameters. The mesh is made at the values of the
    parameters; its nodes move with the boundary, linearly along each edge and by the discrete
    Laplace equation inside, so that results are differentiable by the region. Large changes distort
    the triangles; then make a new mesh.

    Parameters
    ----------
    vertices : places of the vertices of the outline, in order [m]
    size : length of the edges of triangles [m]
    holes : lists of vertices, or ``(center, radius)`` of circles [m]
    kind : ``"triangle6"``, or ``"triangle"`` without nodes in the middles of edges
    parameters : of formulas, by name: ``system.parameters``

    Returns
    -------
    points and cells, with groups of nodes: ``vertex1`` is the first vertex, ``edge1`` the edge from
    it to the second, …, ``hole1`` the boundary of the first hole, …

    Raises
    ------
    ModelError
        Edges that cross or touch, holes that are not inside, a size that is too large or too small.

    Examples
    --------
    >>> from dalembert import structures
    >>> corners = [(0, 0), (2, 0), (2, 1), (0, 1)]
    >>> mesh = structures.polygon_mesh(corners, 0.25, holes=[((1, 0.5), 0.2)])
    >>> list(mesh.point_groups)[:5]
    ['edge1', 'edge2', 'edge3', 'edge4', 'hole1']
    >>> float(mesh.points[mesh.point_groups["edge2"], 0].min())
    2.0
    """
    if kind not in ("triangle", "triangle6"):
        raise ModelError(f"polygon_mesh: unknown kind {kind!r}; known: triangle, triangle6")
    if not (is_number(size) and size > 0):
        raise ModelError(f"the size of triangles is {size!r}; give a positive length", "size")
    region = Region(vertices, holes, parameters or {})
    _check_cells(region, size)
    boundary = Boundary(region.loops, size)
    points, triangles = triangulate(boundary, size)
    rows = [_row(*where) for where in _places(boundary)]
    groups = _groups(boundary)
    weights = _harmonic(region, rows, triangles, len(points)) if region.formulas else None
    if kind == "triangle6":
        points, triangles, weights = _with_middles(boundary, region, points, triangles, weights)
        _add_middles(boundary, triangles, groups)
    for k, number in enumerate(sorted(boundary.corners)[: len(vertices)]):
        groups[f"vertex{k + 1}"] = [number]
    named = {name: np.unique(numbers) for name, numbers in groups.items()}
    if weights is not None:
        points = region.moved(points, *weights)
    return MeshData(points, {kind: triangles}, named)


def _check_cells(region: Region, size: float) -> None:
    cells = math.ceil(region.area / (math.sqrt(3) / 4 * size**2))
    check_budget(
        f"a mesh of {numeral(cells)} triangles", memory=CELL * cells, cure="raise the size"
    )


# nodes of the boundary --------------------------------------------------------------------------
def _places(boundary: Boundary) -> list[tuple[Piece, float]]:
    """Piece and share of its length of each point of the boundary."""
    places: dict[int, tuple[Piece, float]] = {}
    for (i, _), (piece, s, _) in zip(boundary.ends.tolist(), boundary.segments, strict=True):
        places[i] = (piece, s)
    return [places[k] for k in range(len(boundary.points))]


def _row(piece: Piece, share: float) -> list[tuple[int, float, float]]:
    """Number of a coordinate or radius, and the displacement along x and y per unit of it."""
    if isinstance(piece, Edge):
        shares = zip(piece.ends, (1 - share, share), strict=True)
        return [row for k, w in shares for row in ((k, w, 0.0), (k + 1, 0.0, w))]
    number = piece.number
    u, v = piece.direction(share)
    return [(number, 1.0, 0.0), (number + 1, 0.0, 1.0), (number + 2, float(u), float(v))]


def _table(region: Region, rows: Sequence[Any]) -> tuple[np.ndarray, np.ndarray]:
    """(rows, formulas) weights of the displacements along x and y by the numbers with formulas."""
    columns = {number: k for k, number in enumerate(sorted(region.formulas))}
    along_x, along_y = np.zeros((2, len(rows), len(columns)))
    for k, row in enumerate(rows):
        for number, x, y in row:
            if number in columns:
                along_x[k, columns[number]] += x
                along_y[k, columns[number]] += y
    return along_x, along_y


def _harmonic(
    region: Region, rows: Sequence[Any], triangles: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Weights at all points: those inside are the mean of their neighbours."""
    from scipy.sparse import coo_matrix, diags
    from scipy.sparse.linalg import splu

    first = len(rows)
    pairs = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    ones = np.ones(2 * len(pairs))
    i, j = np.concatenate([pairs, pairs[:, ::-1]]).T
    links = coo_matrix((ones, (i, j)), shape=(count, count)).tocsr()
    laplacian = (diags(np.asarray(links.sum(axis=1)).ravel()) - links).tocsc()
    edge = np.hstack(_table(region, rows))
    weights = np.zeros((count, edge.shape[1]))
    weights[:first] = edge
    if count > first:
        solver = splu(laplacian[first:, first:])
        weights[first:] = solver.solve(-(laplacian[first:, :first] @ edge))
    along_x, along_y = np.hsplit(weights, 2)
    return along_x, along_y


# nodes in the middles of edges ------------------------------------------------------------------
def _with_middles(
    boundary: Boundary, region: Region, points: np.ndarray, triangles: np.ndarray, weights: Any
) -> tuple[np.ndarray, np.ndarray, Any]:
    """Quadratic triangles; middles of segments of circles lie on them."""
    sides = np.stack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]], axis=1)
    edges, where = np.unique(np.sort(sides, axis=2).reshape(-1, 2), axis=0, return_inverse=True)
    middles = points[edges].mean(axis=1)
    of_edge = {tuple(edge): k for k, edge in enumerate(edges.tolist())}
    curved = [
        (of_edge[tuple(sorted(ends))], piece, (s + e) / 2)
        for ends, (piece, s, e) in zip(boundary.ends.tolist(), boundary.segments, strict=True)
        if isinstance(piece, Circle)
    ]
    for k, piece, share in curved:
        middles[k] = piece.at(share)
    if weights is not None:
        tables = _table(region, [_row(piece, share) for _, piece, share in curved])
        means = [table[edges].mean(axis=1) for table in weights]
        for mean, table in zip(means, tables, strict=True):
            mean[[k for k, _, _ in curved]] = table
        weights = [np.vstack([w, mean]) for w, mean in zip(weights, means, strict=True)]
    numbers = len(points) + where.reshape(-1, 3)
    return np.vstack([points, middles]), np.hstack([triangles, numbers]), weights


def _groups(boundary: Boundary) -> dict[str, list[int]]:
    groups: dict[str, list[int]] = {}
    for ends, (piece, _, _) in zip(boundary.ends.tolist(), boundary.segments, strict=True):
        groups.setdefault(piece.group, []).extend(ends)
    return groups


def _add_middles(boundary: Boundary, triangles: np.ndarray, groups: dict[str, list[int]]) -> None:
    """Add the nodes between the ends of segments to the groups."""
    between = {
        tuple(sorted((int(cell[k]), int(cell[(k + 1) % 3])))): int(cell[3 + k])
        for cell in triangles
        for k in range(3)
    }
    for ends, (piece, _, _) in zip(boundary.ends.tolist(), boundary.segments, strict=True):
        groups[piece.group].append(between[tuple(sorted(ends))])
