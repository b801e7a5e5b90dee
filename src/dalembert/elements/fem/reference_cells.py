"""Reference cells: nodes, shape functions and integration points.

Shape functions are polynomials of specified monomials that are one at their node and zero at all
others. Nodes are numbered as in VTK and meshio: corners first, then midpoints of edges.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.elements.fem.energies import Rows

DYADIC = 64
"""Common denominator of the coefficients of shape functions."""


@dataclass(frozen=True)
class ReferenceCell:
    """A cell in natural coordinates.

    Attributes
    ----------
    nodes : natural coordinates of the nodes, row by row
    powers : exponents of the monomials, row by row
    samples : ``(ξ, …, weight)`` of the integration points of the strain energy
    kinetic_samples : integration points for products of two shape functions
    """

    nodes: Rows
    powers: tuple[tuple[int, ...], ...]
    samples: Rows
    kinetic_samples: Rows

    @property
    def dimension(self) -> int:
        return len(self.nodes[0])

    @cached_property
    def centre(self) -> tuple[float, ...]:
        """Centre of the corners."""
        corners = self.nodes[: self.corner_count]
        return tuple(float(c) for c in np.mean(corners, axis=0))

    @property
    def corner_count(self) -> int:
        """Number of nodes whose coordinates are ends of the natural interval."""
        low, high = np.min(self.nodes), np.max(self.nodes)
        return sum(all(c in (low, high) for c in node) for node in self.nodes)

    @cached_property
    def _coefficients(self) -> np.ndarray:
        """(monomials, nodes) coefficients, rounded to the common denominator."""
        nodes, powers = np.array(self.nodes), np.array(self.powers)
        values = np.prod(nodes[:, None, :] ** powers, axis=2)
        return np.round(np.linalg.inv(values) * DYADIC) / DYADIC

    def shape_functions(self, point: ca.SX) -> ca.SX:
        """(nodes,) values at natural coordinates."""
        monomials = []
        for row in self.powers:
            term = ca.SX(1)
            for coordinate, power in zip(ca.vertsplit(point), row, strict=True):
                term *= coordinate**power
            monomials.append(term)
        return ca.mtimes(ca.sparsify(ca.DM(self._coefficients.T)), ca.vertcat(*monomials))


def gauss_box(dimension: int, count: int) -> Rows:
    """Gauss points of ``[−1, 1]^d``, ``count`` in each direction: exact to degree 2 count − 1."""
    points, weights = np.polynomial.legendre.leggauss(count)
    grid = np.stack(np.meshgrid(*[points] * dimension, indexing="ij"), axis=-1)
    weight = np.prod(np.meshgrid(*[weights] * dimension, indexing="ij"), axis=0)
    return _rows(grid.reshape(-1, dimension), weight.ravel())


def gauss_simplex(dimension: int, count: int) -> Rows:
    """Gauss points of the unit simplex as a collapsed box (Stroud)."""
    points, weights = np.zeros((1, 0)), np.ones(1)
    remaining = np.ones(1)  # one minus the sum of the coordinates
    for k in range(dimension):
        s, w = gauss_jacobi(count, dimension - 1 - k)
        s, w = (1 + s) / 2, w / 2 ** (dimension - k)
        points = np.column_stack([np.repeat(points, count, axis=0), np.outer(remaining, s).ravel()])
        weights = np.outer(weights, w).ravel()
        remaining = np.outer(remaining, 1 - s).ravel()
    return _rows(points, weights)


def gauss_jacobi(count: int, power: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points of ``[−1, 1]`` with the weight ``(1 − s)^power``, from the eigenvectors of the
    recurrence of Jacobi's polynomials (Golub & Welsch, Math. Comp. 23, 1969)."""
    n, a = np.arange(1.0, count), float(power)
    first = -a / (a + 2)
    diagonal = np.array([first, *(-(a**2) / ((2 * n + a) * (2 * n + a + 2)))])
    off_diagonal = 2 * n * (n + a) / (2 * n + a) / np.sqrt((2 * n + a) ** 2 - 1)
    points, vectors = np.linalg.eigh(
        np.diag(diagonal) + np.diag(off_diagonal, 1) + np.diag(off_diagonal, -1)
    )
    return points, 2 ** (a + 1) / (a + 1) * vectors[0] ** 2


def _rows(points: np.ndarray, weights: np.ndarray) -> Rows:
    return tuple((*map(float, point), float(w)) for point, w in zip(points, weights, strict=True))


def _simplex_corners(dimension: int, inside: float, outside: float) -> Rows:
    """Symmetric points, one near each corner, with equal weights."""
    volume = 1 / (2 if dimension == 2 else 6)
    rows = [[outside] * dimension] + [
        [inside if i == k else outside for i in range(dimension)] for k in range(dimension)
    ]
    return tuple((*row, volume / (dimension + 1)) for row in rows)


def _with_middles(corners: Rows, edges: tuple[tuple[int, int], ...]) -> Rows:
    middles = (
        tuple((a + b) / 2 for a, b in zip(corners[i], corners[j], strict=True)) for i, j in edges
    )
    return (*corners, *middles)


def _powers(dimension: int, allowed) -> tuple[tuple[int, ...], ...]:
    candidates = np.ndindex(*[3] * dimension)
    return tuple(tuple(int(k) for k in row) for row in candidates if allowed(row))


def _serendipity(row) -> bool:
    """Whether at most one coordinate of a monomial is squared."""
    return sum(k == 2 for k in row) < 2


_TRIANGLE: Rows = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
_TETRA: Rows = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_QUAD: Rows = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
_HEXAHEDRON: Rows = tuple((*corner, z) for z in (-1.0, 1.0) for corner in _QUAD)
_TETRA_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
_AROUND = ((0, 1), (1, 2), (2, 3), (3, 0))
_HEXAHEDRON_EDGES = (
    *_AROUND,
    *((i + 4, j + 4) for i, j in _AROUND),
    *((i, i + 4) for i in range(4)),
)
_TRIANGLE_3 = _simplex_corners(2, 2 / 3, 1 / 6)
_TETRA_4 = _simplex_corners(3, (5 + 3 * 5**0.5) / 20, (5 - 5**0.5) / 20)

_LINE: Rows = ((-1.0,), (1.0,))

REFERENCE_CELLS: dict[str, ReferenceCell] = {
    "line": ReferenceCell(
        _LINE, _powers(1, lambda r: max(r) < 2), gauss_box(1, 1), gauss_box(1, 2)
    ),
    "line3": ReferenceCell(
        (*_LINE, (0.0,)), _powers(1, lambda r: True), gauss_box(1, 2), gauss_box(1, 3)
    ),
    "triangle": ReferenceCell(
        _TRIANGLE, _powers(2, lambda r: sum(r) < 2), gauss_simplex(2, 1), _TRIANGLE_3
    ),
    "triangle6": ReferenceCell(
        _with_middles(_TRIANGLE, ((0, 1), (1, 2), (2, 0))),
        _powers(2, lambda r: sum(r) < 3),
        _TRIANGLE_3,
        gauss_simplex(2, 3),
    ),
    "quad": ReferenceCell(
        _QUAD, _powers(2, lambda r: max(r) < 2), gauss_box(2, 2), gauss_box(2, 2)
    ),
    "quad8": ReferenceCell(
        _with_middles(_QUAD, _AROUND), _powers(2, _serendipity), gauss_box(2, 3), gauss_box(2, 4)
    ),
    "tetra": ReferenceCell(_TETRA, _powers(3, lambda r: sum(r) < 2), gauss_simplex(3, 1), _TETRA_4),
    "tetra10": ReferenceCell(
        _with_middles(_TETRA, _TETRA_EDGES),
        _powers(3, lambda r: sum(r) < 3),
        _TETRA_4,
        gauss_simplex(3, 3),
    ),
    "hexahedron": ReferenceCell(
        _HEXAHEDRON, _powers(3, lambda r: max(r) < 2), gauss_box(3, 2), gauss_box(3, 3)
    ),
    "hexahedron20": ReferenceCell(
        _with_middles(_HEXAHEDRON, _HEXAHEDRON_EDGES),
        _powers(3, _serendipity),
        gauss_box(3, 3),
        gauss_box(3, 3),
    ),
}
"""Name of a cell in meshes → reference cell."""
