"""Unstructured grids of VTK."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from dalembert.packages import optional_package


@dataclass
class Grid:
    """Points and cells with their data.

    Attributes
    ----------
    points : (n, 3) [m]
    cells : shape, as meshio names it, and (m, k) points
    point_data : name → (n,) or (n, 3)
    cell_data : name → one array (m,) or (m, 3) for each entry of ``cells``
    """

    points: np.ndarray
    cells: Sequence[tuple[str, np.ndarray]]
    point_data: dict[str, np.ndarray] = field(default_factory=dict)
    cell_data: dict[str, list[np.ndarray]] = field(default_factory=dict)


@dataclass(frozen=True)
class State:
    """Grids of one state.

    Attributes
    ----------
    time : instant, or number of the load case or mode
    parts : name → Grid
    """

    time: float
    parts: dict[str, Grid]


def grid_file(grid: Grid) -> bytes:
    """A grid as a VTU file with compressed binary data."""
    meshio = optional_package("meshio", "VTK")
    cells = [(kind, table) for kind, table in grid.cells if len(table)]
    kept = [k for k, (_, table) in enumerate(grid.cells) if len(table)]
    cell_data = {name: [parts[k] for k in kept] for name, parts in grid.cell_data.items()}
    mesh = meshio.Mesh(grid.points, cells, point_data=grid.point_data, cell_data=cell_data)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "grid.vtu"
        meshio.vtu.write(path, mesh)
        return path.read_bytes()


def some(count: int, limit: int) -> Iterator[int]:
    """Numbers of at most ``limit`` states, the first and the last included."""
    index = np.linspace(0, count - 1, min(count, max(2, limit)))
    return (int(k) for k in np.unique(index.round()))
