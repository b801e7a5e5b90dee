"""Data of a mesh from meshio, a file, or arrays."""

from __future__ import annotations

import io
from collections.abc import Mapping
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.elements.fem.cells import CELLS, cell_name
from dalembert.errors import FileError, ModelError
from dalembert.files import readable
from dalembert.packages import optional_package
from dalembert.text.wording import plain_text

WEIGHT = 4
"""Memory for reading a file, relative to its size."""
FLAT = 1e-9
"""Threshold of the height, relative to the extent, below which points lie in a plane."""


@dataclass(frozen=True)
class MeshData:
    """Points, cells by shape, and groups of both.

    Attributes
    ----------
    points : (count, d) [m]
    cells : shape → (cells, nodes) numbers of points
    point_groups : name → numbers of points
    cell_groups : name → shape → numbers of cells
    """

    points: np.ndarray
    cells: dict[str, np.ndarray]
    point_groups: dict[str, np.ndarray] = field(default_factory=dict)
    cell_groups: dict[str, dict[str, np.ndarray]] = field(default_factory=dict)

    def nodes_of(self, group: str) -> np.ndarray:
        """Numbers of the points of a group, in rising order."""
        parts = [np.asarray(self.point_groups.get(group, []), dtype=int)]
        for shape, numbers in self.cell_groups.get(group, {}).items():
            parts.append(self.cells[shape][numbers].ravel())
        return np.unique(np.concatenate(parts))

    def reduced(self, shapes: list[str]) -> MeshData:
        """The mesh without the points that belong to no cell of these shapes.

        Groups keep the nodes of other cells, such as the edges of an area.
        """
        used = np.unique(np.concatenate([self.cells[s].ravel() for s in shapes]))
        number = np.full(len(self.points), -1)
        number[used] = np.arange(used.size)
        groups = {name: number[self.nodes_of(name)] for name in self._group_names()}
        groups_kept = {name: numbers[numbers >= 0] for name, numbers in groups.items()}
        cells = {s: number[self.cells[s]] for s in shapes}
        cell_groups = {
            name: {s: k for s, k in members.items() if s in shapes}
            for name, members in self.cell_groups.items()
        }
        return MeshData(
            self.points[used], cells, groups_kept, {n: m for n, m in cell_groups.items() if m}
        )

    def _group_names(self) -> list[str]:
        return [*dict.fromkeys([*self.point_groups, *self.cell_groups])]


def mesh_data(source: Any, name: str) -> MeshData:
    """The mesh in a file, a ``meshio.Mesh``, arrays ``(points, cells)``, or a ``MeshData``.

    Raises
    ------
    FileError
        The file cannot be read as a mesh.
    UnsupportedError
        meshio is needed and not installed.
    ModelError
        Arrays that do not form a mesh.
    """
    if isinstance(source, (str, Path)):
        return _from_meshio(_read(Path(source)), name)
    if isinstance(source, MeshData):
        return _checked(source, name)
    if isinstance(source, tuple) and len(source) == 2:
        return _from_arrays(*source, name)
    if hasattr(source, "points") and hasattr(source, "cells"):
        return _from_meshio(source, name)
    raise ModelError(
        f"a mesh is a meshio.Mesh, the path of a file, or (points, cells); got {source!r:.60}", name
    )


def _read(path: Path) -> Any:
    meshio = optional_package("meshio", f"reading {path}")
    if not readable(path, WEIGHT):
        raise FileError(f"{path}: the file is empty")
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):  # meshio prints
            return meshio.read(path)
    except SystemExit:  # meshio exits if no reader accepts the file
        raise FileError(f"{path}: cannot be read as a mesh; meshio lists its formats") from None
    except Exception as error:  # the readers raise errors of many types
        raise FileError(f"{path}: cannot be read as a mesh ({error})") from None


def _from_meshio(mesh: Any, name: str) -> MeshData:
    cells: dict[str, list[np.ndarray]] = {}
    groups: dict[str, dict[str, list[np.ndarray]]] = {}
    for k, block in enumerate(mesh.cells):
        shape, rows = block.type, np.asarray(block.data, dtype=int)
        if shape not in CELLS:
            raise ModelError(f"cells {shape!r} are not known; known: {', '.join(CELLS)}", name)
        first = sum(map(len, cells.get(shape, [])))
        for group, numbers in _groups_of(mesh, k):
            groups.setdefault(group, {}).setdefault(shape, []).append(first + numbers)
        cells.setdefault(shape, []).append(rows)
    points = _flattened(np.asarray(mesh.points, dtype=float))
    cells_by_shape = {shape: np.concatenate(rows) for shape, rows in cells.items()}
    members = {
        group: {shape: np.concatenate(n) for shape, n in members_by_shape.items()}
        for group, members_by_shape in groups.items()
    }
    named = {n: np.asarray(k, dtype=int) for n, k in getattr(mesh, "point_sets", {}).items()}
    return _checked(MeshData(points, cells_by_shape, named, members), name)


def _groups_of(mesh: Any, block: int) -> list[tuple[str, np.ndarray]]:
    """Groups with cells of one block, and their numbers in it."""
    groups = {
        name: np.asarray(blocks[block], dtype=int)
        for name, blocks in getattr(mesh, "cell_sets", {}).items()
        if not name.startswith("gmsh:") and blocks[block] is not None
    }
    tags = mesh.cell_data.get("gmsh:physical")
    dimension = CELLS[mesh.cells[block].type].dimension
    for name, (tag, of) in getattr(mesh, "field_data", {}).items():
        if tags is not None and of == dimension and name not in groups:
            groups[name] = np.flatnonzero(np.asarray(tags[block]) == tag)
    return [(name, numbers) for name, numbers in groups.items() if numbers.size]


def _flattened(points: np.ndarray) -> np.ndarray:
    """Points with two coordinates if all lie in the plane ``z = 0``."""
    extent = float(np.ptp(points, axis=0).max(initial=0.0)) if points.size else 0.0
    flat = points.shape[1] == 3 and np.abs(points[:, 2]).max(initial=0.0) <= FLAT * extent
    return points[:, :2].copy() if flat else points


def _from_arrays(points: Any, cells: Any, name: str) -> MeshData:
    positions = np.asarray(points)
    if positions.ndim == 1:
        positions = positions[:, None]
    if positions.ndim != 2 or not 1 <= positions.shape[1] <= 3:
        raise ModelError(f"points must be an array (count, 1 to 3), got {positions.shape}", name)
    if not isinstance(cells, Mapping):
        rows = np.asarray(cells)
        shape = cell_name(rows.shape[1], positions.shape[1]) if rows.ndim == 2 else None
        if shape is None:
            raise ModelError(
                f"cells of shape {rows.shape} are no cells in {positions.shape[1]} dimension(s); "
                'give them by shape, e.g. {"quad": cells}',
                name,
            )
        cells = {shape: rows}
    unknown = [shape for shape in cells if shape not in CELLS]
    if unknown:
        raise ModelError(f"cells {unknown[0]!r} are not known; known: {', '.join(CELLS)}", name)
    return _checked(MeshData(positions, {s: np.asarray(c) for s, c in cells.items()}), name)


def _checked(data: MeshData, name: str) -> MeshData:
    if not data.cells:
        raise ModelError("the mesh has no cells", name)
    for group in (*data.point_groups, *data.cell_groups):
        plain_text(group, f"{name}: group of the mesh")
    for shape, rows in data.cells.items():
        count = CELLS[shape].nodes
        if rows.ndim != 2 or rows.shape[1] != count or rows.dtype.kind not in "iu":
            raise ModelError(
                f"cells {shape!r} must be whole numbers (count, {count}), got {rows.shape}", name
            )
        if rows.size and (rows.min() < 0 or rows.max() >= len(data.points)):
            raise ModelError(
                f"cells {shape!r} count points up to {rows.max()}, there are {len(data.points)}",
                name,
            )
    return data
