"""From a checked document to a structure."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.elements.fem.node import Node
from dalembert.elements.fem.registry import ELEMENTS, cell_of
from dalembert.errors import ModelError
from dalembert.io.fields import Quantities, Quantity, connected, given_fields
from dalembert.io.formulas import Formulas, ParameterNames, Scope
from dalembert.io.location import Located
from dalembert.io.parameters import declare_parameters
from dalembert.io.shapes import made_of
from dalembert.io.structure_schema import StructureDocument
from dalembert.io.structure_tables import (
    DISPLACEMENTS,
    FORCES,
    LINE_FORCES,
    TEMPERATURES,
    TRACTIONS,
    VELOCITIES,
    NodeChoice,
)
from dalembert.structures.mesh import Mesh
from dalembert.structures.mesh_generators import box_mesh, line_mesh, rectangle_mesh
from dalembert.structures.nodes import Nodes
from dalembert.structures.structure import Structure
from dalembert.text import unknown, visible


class StructureBuilder:
    """Makes the structure that a document describes.

    Parameters
    ----------
    document : StructureDocument
    source : path of the file, for messages and for the files it names
    """

    def __init__(self, document: StructureDocument, source: Path):
        self.document, self.source = document, source
        self.located = Located(source, document)
        self.structure = Structure(document.name or visible(source.stem), document.description)
        self.formulas = Formulas(ParameterNames(self.structure.parameters))
        self.meshes: dict[str, Mesh] = {}

    def build(self) -> Structure:
        """The structure.

        Raises
        ------
        ModelError, FileError, UnsupportedError
            With file, place, value and cure.
        """
        declare_parameters(self.structure, self.document, self.located)
        for name, place in self.document.nodes.items():
            with self.located("nodes", name):
                self.structure.node(name, *(self.formulas.read(x) for x in place))
        for name, table in self.document.elements.items():
            self.element(name, table)
        for name, table in self.document.meshes.items():
            self.mesh(name, table)
        self.on_nodes("supports", self.structure.support, DISPLACEMENTS)
        self.on_nodes("loads", self.structure.load, FORCES, "case", "fixed_axes")
        self.spread_loads()
        self.on_nodes("initial", self.structure.initial, DISPLACEMENTS | VELOCITIES)
        return self.structure

    # elements --------------------------------------------------------------------------------
    def element(self, name: str, table: Any) -> None:
        cls, where = ELEMENTS[table.type], ("elements", name)
        with self.located(*where):
            ends = [self.node(end, *where, "connect", k) for k, end in enumerate(table.connect)]
            ties = [tuple(ends)] if len(connected(cls)) < len(ends) else ends
            keys = given_fields(cls, table, self.located, where, self.value)
            self.structure.add(made_of(cls, name, *ties, **keys))

    def node(self, name: str, *where: str | int) -> Node:
        known = self.document.nodes
        if name not in known:
            raise self.located.error(unknown("node", name, known), *where)
        return self.structure.nodes[name]  # type: ignore[return-value]

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

    # meshes ----------------------------------------------------------------------------------
    def mesh(self, name: str, table: Any) -> None:
        cls, where = ELEMENTS[table.type], ("meshes", name)
        shape = cell_of(cls)
        with self.located(*where):
            keys = given_fields(cls, table, self.located, where, self.value)
            source = self.mesh_source(table, shape, where)
            self.meshes[name] = self.structure.add_mesh(name, source, {shape: cls}, **keys)

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

    # supports and loads ----------------------------------------------------------------------
    def on_nodes(
        self, section: str, act: Callable, directions: dict[str, str], *plain: str
    ) -> None:
        """Call ``act(nodes, direction=value, …)`` for each table of a section."""
        for k, table in enumerate(getattr(self.document, section)):
            with self.located(section, k):
                options = self.directed(table, directions, section, k)
                options |= {key: getattr(table, key) for key in plain}
                for nodes in self.chosen(table, section, k):
                    act(nodes, **options)

    def spread_loads(self) -> None:
        """Loads on the insides of elements, on lines, edges and faces."""
        table: Any
        for k, given in enumerate(self.document.gravity):
            with self.located("gravity", k):
                field = [self.formulas.read(x) for x in given.acceleration]
                self.structure.gravity(*field, case=given.case)
        for k, table in enumerate(self.document.line_loads):
            with self.located("line_loads", k):
                options = self.directed(table, LINE_FORCES, "line_loads", k)
                parts = [self.part(n, "line_loads", k, "elements") for n in table.elements]
                self.structure.line_load(parts, case=table.case, **options)
        for k, table in enumerate(self.document.temperatures):
            with self.located("temperatures", k):
                options = self.directed(table, TEMPERATURES, "temperatures", k)
                parts = [self.part(n, "temperatures", k, "elements") for n in table.elements]
                self.structure.heat(parts, case=table.case, **options)
        for k, table in enumerate(self.document.tractions):
            with self.located("tractions", k):
                options = self.directed(table, TRACTIONS, "tractions", k)
                part = self.part(table.elements, "tractions", k, "elements")
                for nodes in self.chosen(table, "tractions", k):
                    if not isinstance(nodes, Nodes):
                        raise ModelError(f"{nodes.name} is one node; take nodes of the mesh")
                    self.structure.traction(part, nodes, case=table.case, **options)

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

    def part(self, name: str, *where: str | int) -> Any:
        """The element or element set of this name."""
        known = self.structure.elements
        if name not in known:
            raise self.located.error(unknown("element", name, known), *where)
        return known[name]

    def chosen(self, table: NodeChoice, section: str, k: int) -> list[Node | Nodes]:
        """The nodes that a table of supports or loads means."""
        found = [self.named(name, section, k) for name in table.nodes]
        if table.where is None and table.nearest is None:
            return found
        narrowed: list[Node | Nodes] = []
        for nodes in found:
            if not isinstance(nodes, Nodes):
                raise ModelError(f"{nodes.name} is one node; where and nearest choose among many")
            chosen = nodes if table.where is None else nodes.where(**table.where)
            if table.nearest is not None:
                if len(table.nearest) != nodes.dimension:
                    raise ModelError(f"nearest needs {nodes.dimension} coordinates")
                chosen = chosen.nearest(*table.nearest)
            narrowed.append(chosen)
        return narrowed

    def named(self, name: str, section: str, k: int) -> Node | Nodes:
        """The node, the nodes of a mesh, or those of a group of it."""
        if name in self.document.nodes:
            return self.node(name)
        owner, _, group = name.partition(".")
        if owner in self.meshes:
            with self.located(section, k, "nodes"):
                return self.meshes[owner].nodes(group or None)
        known = [*self.document.nodes, *self.meshes]
        known += [f"{mesh}.{g}" for mesh, m in self.meshes.items() for g in m.selections]
        raise self.located.error(unknown("nodes", name, known), section, k, "nodes")


def _array(values: list) -> np.ndarray:
    """Numbers as such, formulas as objects."""
    if all(isinstance(v, (int, float)) for v in values):
        return np.array(values, dtype=float)
    found = np.empty(len(values), dtype=object)
    found[:] = values
    return found
