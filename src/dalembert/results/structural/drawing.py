"""Drawing of a structure: vertices, lines, faces and points, and their displacements."""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatchmethod

import numpy as np

from dalembert.elements.base import Look
from dalembert.elements.fem.nodal import ROTATIONS
from dalembert.elements.look import (
    Bars,
    Beams,
    Cells,
    Coils,
    Dots,
    Faces,
    SolidFaces,
    Support,
)
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.structural.shapes import (
    COIL,
    SHARP_ANGLE,
    between,
    cubic,
    exposed_faces,
    lanes,
    samples,
    tilted_tangent,
    turned_tangent,
)


class StructuralDrawing:
    """Vertices, lines, faces and points of a structure; the first vertices are the nodes.

    Parameters
    ----------
    model : StructuralModel
    p : (np,) parameter values

    Attributes
    ----------
    rest : (v, 3) undeformed positions [m]
    lines, faces, points : drawn cells
    prescribed : number of a node → its prescribed directions
    """

    def __init__(self, model: StructuralModel, p: np.ndarray):
        self.model, self.dimension = model, model.degrees.dimension
        self.starts = np.cumsum([0, *(block.count for block in model.blocks)])
        self.lines: list[Cells] = []
        self.faces: list[Cells] = []
        self.points: list[Cells] = []
        self.prescribed: dict[int, set[str]] = {}
        self.rest = self.positions([block.data(p) for block in model.blocks])
        self.node_count = len(self.rest)
        self.curves: list[tuple[Cells, np.ndarray, slice]] = []
        self._solids: list[Cells] = []
        for look in model.look():
            self.draw(look)
        self.faces += exposed_faces(self._solids)

    @property
    def extent(self) -> float:
        """Size of the structure [m]."""
        return float(np.ptp(self.rest, axis=0).max(initial=0.0)) or 1.0

    @property
    def nodes(self) -> np.ndarray:
        """(n, 3) positions of the nodes [m]."""
        return self.rest[: self.node_count]

    @property
    def element_names(self) -> list[str]:
        """Names of all elements, block by block."""
        return [name for block in self.model.blocks for name in block.names.names]

    def displaced(self, u: np.ndarray, finite: bool = False) -> np.ndarray:
        """(v, 3) displacements of the vertices.

        Parameters
        ----------
        u : (n,) displacements and rotations of the structure
        finite : whether rotations are finite, as rotation vectors
        """
        return self.displaced_from(self.nodes, u, finite)

    def displaced_from(self, nodes: np.ndarray, u: np.ndarray, finite: bool = False) -> np.ndarray:
        """(v, 3) displacements of the vertices for positions (n, 3) of the nodes.

        Positions and displacements may be objects, formulas of parameters and measures.
        """
        moved = np.zeros(self.rest.shape, dtype=u.dtype)
        moved[: self.node_count] = self.translations(u)
        for cells, along, rows in self.curves:
            moved[rows] = self._curve(cells, along, nodes, u, finite).reshape(-1, 3)
        return moved

    def outline(self) -> np.ndarray:
        """(k, 2) vertices of boundary edges and sharp edges of the faces."""
        if not self.faces:
            return np.zeros((0, 2), dtype=int)
        edges, normals = [], []
        for shape in self.faces:
            corner = self.rest[shape.vertices]
            normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, -1] - corner[:, 0])
            normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
            around = np.stack([shape.vertices, np.roll(shape.vertices, -1, axis=1)], axis=2)
            edges.append(np.sort(around.reshape(-1, 2), axis=1))
            normals.append(np.repeat(normal, shape.vertices.shape[1], axis=0))
        unique_edges, inverse, counts = np.unique(
            np.concatenate(edges), axis=0, return_inverse=True, return_counts=True
        )
        total = np.zeros((len(unique_edges), 3))
        np.add.at(total, inverse.ravel(), np.concatenate(normals))
        smooth = (counts == 2) & (np.linalg.norm(total, axis=1) > 2 * np.cos(SHARP_ANGLE / 2))
        return unique_edges[~smooth]

    # nodes ---------------------------------------------------------------------------------
    def positions(self, data: Sequence[np.ndarray]) -> np.ndarray:
        """(n, 3) positions of the nodes, from the data (m, ne) of each block of elements."""
        d = self.dimension
        kind = object if any(columns.dtype == object for columns in data) else float
        positions = np.zeros((len(self.model.degrees.nodes), 3), dtype=kind)
        for block, columns in zip(self.model.blocks, data, strict=True):
            for k, nodes in enumerate(block.nodes):
                positions[nodes, :d] = columns[k * d : (k + 1) * d].T
        return positions

    def translations(self, u: np.ndarray) -> np.ndarray:
        """(n, 3) displacements of the nodes."""
        numbers = self.model.degrees.table[:, : self.dimension]
        moved = np.zeros((len(numbers), 3), dtype=u.dtype)
        moved[:, : self.dimension] = np.where(numbers >= 0, u[numbers], 0.0)
        return moved

    def rotations(self, u: np.ndarray) -> np.ndarray:
        """(n, 3) rotation vectors of the nodes."""
        numbers = self.model.degrees.table[:, self.dimension :]
        turned = np.zeros((len(numbers), 3), dtype=u.dtype)
        axes = [("rx", "ry", "rz").index(r) for r in ROTATIONS[self.dimension]]
        turned[:, axes] = np.where(numbers >= 0, u[numbers], 0.0)
        return turned

    # primitives ----------------------------------------------------------------------------
    @singledispatchmethod
    def draw(self, look: Look) -> None:
        """Add a primitive."""
        raise NotImplementedError(f"{type(look).__name__} has no drawing")

    @draw.register
    def _(self, look: Bars) -> None:
        if self.dimension == 1:
            self._add_curves(look, np.linspace(0, 1, samples(len(look.elements))))
        else:
            self.lines.append(look)

    @draw.register
    def _(self, look: Beams) -> None:
        self._add_curves(look, np.linspace(0, 1, samples(len(look.elements))))

    @draw.register
    def _(self, look: Coils) -> None:
        self._add_curves(look, COIL)

    @draw.register
    def _(self, look: Faces) -> None:
        self.faces.append(look)

    @draw.register
    def _(self, look: SolidFaces) -> None:
        self._solids.append(look)

    @draw.register
    def _(self, look: Dots) -> None:
        self.points.append(look)

    @draw.register
    def _(self, look: Support) -> None:
        self.prescribed.setdefault(look.node, set()).add(look.direction)

    # lines ---------------------------------------------------------------------------------
    def _add_curves(self, look: Cells, along: np.ndarray) -> None:
        """Add lines with vertices between their ends; in one dimension side by side."""
        ends = self.nodes[look.vertices.T]  # (2, ne, 3)
        flat = self.dimension == 1
        if flat:
            along = np.array([0, *along, 1])
        positions = between(ends, along)
        if isinstance(look, Coils):
            positions += self._turns(ends, along)
        if flat:
            height = 0.1 * np.ptp(self.rest[:, 0]) * lanes(np.sort(ends[:, :, 0], axis=0).T)
            positions[:, 1:-1, 1] += height[:, None]
        first = len(self.rest)
        rows = slice(first, first + positions.shape[0] * positions.shape[1])
        self.rest = np.vstack([self.rest, positions.reshape(-1, 3)])
        numbers = np.arange(rows.start, rows.stop).reshape(positions.shape[:2])
        self.lines.append(type(look)(numbers, look.elements))
        self.curves.append((look, along, rows))

    def _turns(self, ends: np.ndarray, along: np.ndarray) -> np.ndarray:
        """(ne, s, 3) lateral offsets of the turns of springs."""
        chord = ends[1] - ends[0]
        across = np.cross([0.0, 0.0, 1.0], chord)
        vertical = np.linalg.norm(across, axis=1) < 1e-9 * np.linalg.norm(chord, axis=1)
        across[vertical] = np.cross([1.0, 0.0, 0.0], chord[vertical])
        size = np.linalg.norm(across, axis=1, keepdims=True)
        across = np.divide(across, size, out=np.zeros_like(across), where=size > 0)
        inner = np.flatnonzero((along > 0.2) & (along < 0.8))
        side = np.zeros(along.size)
        side[inner] = np.where(np.arange(inner.size) % 2, -1.0, 1.0)
        width = 0.015 * float(np.ptp(self.nodes, axis=0).max())
        return width * side[None, :, None] * across[:, None, :]

    def _curve(
        self, look: Cells, along: np.ndarray, places: np.ndarray, u: np.ndarray, finite: bool
    ) -> np.ndarray:
        """(ne, s, 3) displacements along lines; cubic if the ends have rotations."""
        nodes = look.vertices.T
        moved = self.translations(u)[nodes]
        if not isinstance(look, Beams):
            return between(moved, along)
        chord = places[nodes[1]] - places[nodes[0]]
        turned = self.rotations(u)[nodes]
        after = chord + moved[1] - moved[0]
        tangent = turned_tangent if finite else tilted_tangent
        return cubic(moved, [tangent(r, chord, after) for r in turned], along)
