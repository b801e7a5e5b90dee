"""What files of structures and of mechanisms say alike of finite elements and their meshes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.elements.fem.registry import ELEMENTS, cell_of
from dalembert.errors import ModelError
from dalembert.io.fields import Quantities, Quantity, connected_fields, read_fields
from dalembert.io.formulas import Formulas, Scope
from dalembert.io.location import Located
from dalembert.io.shapes import construct
from dalembert.io.structures.tables import NodeChoice
from dalembert.structures.meshes.generators import box_mesh, line_mesh, rectangle_mesh
from dalembert.structures.nodes import Nodes


class MeshReader:
    """Reads the tables of elements and meshes of one file.

    Parameters
    ----------
    source : path of the file, for messages and for the files it names
    located : for messages
    formulas : reads numbers
    """

    def __init__(self, source: Path, located: Located, formulas: Formulas):
        self.source, self.located, self.formulas = source, located, formulas

    def element(
        self, name: str, table: Any, node: Callable[..., Any], add: Callable[..., Any]
    ) -> None:
        """Add an element between nodes that ``node(name, *where)`` finds."""
        cls, where = ELEMENTS[table.type], ("elements", name)
        with self.located(*where):
            ends = [node(end, *where, "connect", k) for k, end in enumerate(table.connect)]
            ties = [tuple(ends)] if len(connected_fields(cls)) < len(ends) else ends
            keys = read_fields(cls, table, self.located, where, self.value)
            add(construct(cls, name, *ties, **keys))

    def mesh(self, name: str, table: Any, add: Callable[..., Any]) -> Any:
        """What ``add(name, source, {shape: class}, **quantities)`` makes of a mesh."""
        cls, where = ELEMENTS[table.type], ("meshes", name)
        shape = cell_of(cls)
        with self.located(*where):
            keys = read_fields(cls, table, self.located, where, self.value)
            return add(name, self.mesh_source(table, shape, where), {shape: cls}, **keys)

    def value(self, field: Any, given: Any, where: tuple[str, ...]) -> Any:
        """What a field of a class of elements holds; of meshes one for all, each, or each group."""
        if field.holds not in (Quantity, Quantities):
            return given
        if isinstance(given, dict):
            return {group: self.formulas.read(v) for group, v in given.items()}
        if not isinstance(given, list):
            return self.formulas.read(given)
        made = [self.formulas.read(v) for v in given]
        return made if field.holds is Quantities else _array(made)

    def mesh_source(self, table: Any, shape: str, where: tuple[str, ...]) -> Any:
        """A path, or points and cells."""
        makers: dict[str, Callable[[], Any]] = {
            "file": lambda: self.source.parent / table.file,
            "points": lambda: self.points(table, shape, where),
            "rectangle": lambda: rectangle_mesh(
                table.rectangle.size, table.rectangle.counts, shape
            ),
            "box": lambda: box_mesh(table.box.size, table.box.counts, shape),
            "line": lambda: line_mesh(table.line.start, table.line.end, table.line.count),
        }
        given = [key for key in makers if getattr(table, key) is not None]
        if len(given) != 1:
            told = ", ".join(given) or "none"
            raise self.located.error(f"give one of {', '.join(makers)}; got {told}", *where)
        with self.located(*where, given[0]):
            return makers[given[0]]()

    def points(self, table: Any, shape: str, where: tuple[str, ...]) -> Any:
        if table.cells is None:
            raise self.located.error("is missing; points need cells", *where, "cells")
        if len({len(r) for r in table.points}) != 1 or len({len(c) for c in table.cells}) != 1:
            raise ModelError("rows have different lengths")
        points = [[self.formulas.read(x) for x in place] for place in table.points]
        flat = _array([x for place in points for x in place])
        return flat.reshape(len(points), -1), {shape: np.array(table.cells)}

    def directed(
        self, table: Any, directions: dict[str, str], section: str, k: int
    ) -> dict[str, Any]:
        """The values that a table gives by direction."""
        found = {}
        for key in directions:
            if key in table.model_fields_set:
                with self.located(section, k, key):
                    found[key] = self.formulas.read(getattr(table, key), Scope.TIME)
        return found


def narrowed(nodes: Any, table: NodeChoice) -> Any:
    """Those of some nodes that a table means by their places."""
    if table.where is None and table.nearest is None:
        return nodes
    if not isinstance(nodes, Nodes):
        raise ModelError(f"{nodes.name} is one node; where and nearest choose among many")
    chosen = nodes if table.where is None else nodes.where(**table.where)
    if table.nearest is None:
        return chosen
    if len(table.nearest) != nodes.dimension:
        raise ModelError(f"nearest needs {nodes.dimension} coordinates")
    return chosen.nearest(*table.nearest)


def _array(values: list) -> np.ndarray:
    """Numbers as such, formulas as objects."""
    if all(isinstance(v, (int, float)) for v in values):
        return np.array(values, dtype=float)
    found = np.empty(len(values), dtype=object)
    found[:] = values
    return found
