"""Finite elements and meshes in the files of structures and mechanisms."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.elements.fem.between_bodies import NodeBody
from dalembert.elements.fem.registry import ELEMENTS, cell_of
from dalembert.elements.fem.sets import Nodes
from dalembert.errors import ModelError
from dalembert.io.fields import Quantities, Quantity, connected_fields, read_fields
from dalembert.io.formulas import Formulas, Scope
from dalembert.io.laws_and_curves import construct
from dalembert.io.location import Located
from dalembert.io.schema import Document
from dalembert.io.structures.structure_tables import DISPLACEMENTS, FORCES, NodeChoice
from dalembert.model.elastic_structure import ElasticStructure
from dalembert.model.meshes.generators import box_mesh, line_mesh, rectangle_mesh
from dalembert.model.system import System
from dalembert.text.wording import unknown


class MeshReader:
    """Reader of the element and mesh tables of one file.

    Parameters
    ----------
    source : path of the file, for messages and relative paths
    located : for messages
    formulas : reads numbers
    """

    def __init__(self, source: Path, located: Located, formulas: Formulas):
        self.source, self.located, self.formulas = source, located, formulas

    def element(
        self, name: str, table: Any, node: Callable[..., Any], add: Callable[..., Any]
    ) -> None:
        """Add an element between the nodes that ``node(name, *where)`` returns."""
        cls, where = ELEMENTS[table.type], ("elements", name)
        with self.located(*where):
            nodes = [node(end, *where, "connect", k) for k, end in enumerate(table.connect)]
            connections = [tuple(nodes)] if len(connected_fields(cls)) < len(nodes) else nodes
            keys = read_fields(cls, table, self.located, where, self.value)
            add(construct(cls, name, *connections, **keys))

    def mesh(self, name: str, table: Any, add: Callable[..., Any]) -> Any:
        """Add a mesh by ``add(name, source, {shape: class}, **quantities)``."""
        cls, where = ELEMENTS[table.type], ("meshes", name)
        shape = cell_of(cls)
        with self.located(*where):
            keys = read_fields(cls, table, self.located, where, self.value)
            return add(name, self.mesh_source(table, shape, where), {shape: cls}, **keys)

    def value(self, field: Any, entry: Any, where: tuple[str, ...]) -> Any:
        """Value of a field; of meshes one for all elements, one per element or one per group."""
        if field.holds not in (Quantity, Quantities):
            return entry
        if isinstance(entry, dict):
            return {group: self.formulas.read(v) for group, v in entry.items()}
        if not isinstance(entry, list):
            return self.formulas.read(entry)
        values = [self.formulas.read(v) for v in entry]
        return values if field.holds is Quantities else _array(values)

    def mesh_source(self, table: Any, shape: str, where: tuple[str, ...]) -> Any:
        """Path of a mesh file, or points and cells."""
        makers: dict[str, Callable[[], Any]] = {
            "file": lambda: self.source.parent / table.file,
            "points": lambda: self.points(table, shape, where),
            "rectangle": lambda: rectangle_mesh(
                table.rectangle.size, table.rectangle.counts, shape
            ),
            "box": lambda: box_mesh(table.box.size, table.box.counts, shape),
            "line": lambda: line_mesh(table.line.start, table.line.end, table.line.count),
        }
        keys = [key for key in makers if getattr(table, key) is not None]
        if len(keys) != 1:
            listed = ", ".join(keys) or "none"
            raise self.located.error(f"give one of {', '.join(makers)}; got {listed}", *where)
        with self.located(*where, keys[0]):
            return makers[keys[0]]()

    def points(self, table: Any, shape: str, where: tuple[str, ...]) -> Any:
        if table.cells is None:
            raise self.located.error("is missing; points need cells", *where, "cells")
        if len({len(r) for r in table.points}) != 1 or len({len(c) for c in table.cells}) != 1:
            raise ModelError("rows have different lengths")
        points = [[self.formulas.read(x) for x in coordinates] for coordinates in table.points]
        flat = _array([x for coordinates in points for x in coordinates])
        return flat.reshape(len(points), -1), {shape: np.array(table.cells)}

    def directed(
        self, table: Any, directions: dict[str, str], section: str, k: int
    ) -> dict[str, Any]:
        """Values given by direction."""
        values = {}
        for key in directions:
            if key in table.model_fields_set:
                with self.located(section, k, key):
                    values[key] = self.formulas.read(getattr(table, key), Scope.TIME)
        return values


class FiniteElements:
    """Adds finite elements, supports and loads to a system that has its bodies.

    Parameters
    ----------
    document : Document
    reader : MeshReader
    system : System
    """

    def __init__(self, document: Document, reader: MeshReader, system: System):
        self.document, self.reader, self.system = document, reader, system
        self.located = reader.located

    def add(self) -> None:
        """Add elements between nodes, and meshes."""
        for name, table in self.document.elements.items():
            self.reader.element(name, table, self.node, self.system.add)
        for name, table in self.document.meshes.items():
            self.reader.mesh(name, table, self.system.add_mesh)

    def add_loads(self) -> None:
        """Add supports and loads."""
        actions = {
            "supports": (self.system.support, DISPLACEMENTS),
            "loads": (self.system.load, FORCES),
        }
        for section, (act, directions) in actions.items():
            table: Any
            for k, table in enumerate(getattr(self.document, section)):
                with self.located(section, k):
                    values = self.reader.directed(table, directions, section, k)
                    act(self.selected(table, section, k), **values)

    def node(self, name: str, *where: str | int) -> NodeBody:
        """The body of this name, which must be a node."""
        bodies = {n: b for n, b in self.system.elements.items() if isinstance(b, NodeBody)}
        meshes = self.document.meshes if "connect" not in where else ()
        if name not in bodies:
            if name in self.document.bodies:
                text = f'{name!r} is no node; give it type = "Node" or "PointNode"'
                raise self.located.error(text, *where)
            raise self.located.error(unknown("node", name, [*bodies, *meshes]), *where)
        return bodies[name]

    def selected(self, table: NodeChoice, section: str, k: int) -> list[NodeBody]:
        """The nodes that a table of supports or loads selects."""
        nodes: list[NodeBody] = []
        for name in table.nodes:
            owner, _, group = name.partition(".")
            if owner in self.document.meshes:
                with self.located(section, k, "nodes"):
                    nodes += self.of_mesh(owner, group, table)
                continue
            nodes.append(selected_nodes(self.node(name, section, k, "nodes"), table))
        return nodes

    def of_mesh(self, owner: str, group: str, table: NodeChoice) -> list[NodeBody]:
        """Selected nodes of a mesh: all, one by its name, or those of a group."""
        structure = self.system.elements[owner]
        assert isinstance(structure, ElasticStructure)
        if group in structure.named_nodes:
            return [structure.named_nodes[group]]
        return structure.at(selected_nodes(structure.mesh.nodes(group or None), table))


def selected_nodes(nodes: Any, table: NodeChoice) -> Any:
    """Nodes that a table selects by position."""
    if table.where is None and table.nearest is None:
        return nodes
    if not isinstance(nodes, Nodes):
        raise ModelError(f"{nodes.name} is one node; where and nearest select among several")
    selected = nodes if table.where is None else nodes.where(**table.where)
    if table.nearest is None:
        return selected
    if len(table.nearest) != nodes.dimension:
        raise ModelError(f"nearest needs {nodes.dimension} coordinates")
    return selected.nearest(*table.nearest)


def _array(values: list) -> np.ndarray:
    """Array of floats, or of objects if there are formulas."""
    if all(isinstance(v, (int, float)) for v in values):
        return np.array(values, dtype=float)
    array = np.empty(len(values), dtype=object)
    array[:] = values
    return array
