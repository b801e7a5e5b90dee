"""Construction of a structure from a validated document."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from dalembert.elements.fem.node import Node
from dalembert.elements.fem.sets import Nodes
from dalembert.errors import ModelError
from dalembert.io.declarations import declare_parameters, declare_tables
from dalembert.io.formulas import Formulas, ParameterNames
from dalembert.io.location import Located
from dalembert.io.structures.finite_elements import MeshReader, selected_nodes
from dalembert.io.structures.structure_schema import StructureDocument
from dalembert.io.structures.structure_tables import (
    DISPLACEMENTS,
    FORCES,
    LINE_FORCES,
    TEMPERATURES,
    TRACTIONS,
    VELOCITIES,
    NodeChoice,
)
from dalembert.model.structure import Structure
from dalembert.text.wording import unknown, visible


class StructureBuilder:
    """Builder of the structure that a document describes.

    Parameters
    ----------
    document : StructureDocument
    source : path of the file, for messages and relative paths
    """

    def __init__(self, document: StructureDocument, source: Path):
        self.document, self.source = document, source
        self.located = Located(source, document)
        self.structure = Structure(document.name or visible(source.stem), document.description)
        self.formulas = Formulas(ParameterNames(self.structure.parameters, self.structure.tables))
        self.reader = MeshReader(source, self.located, self.formulas)

    def build(self) -> Structure:
        """The structure.

        Raises
        ------
        ModelError, FileError, UnsupportedError
            Names file, location, value and a fix.
        """
        declare_parameters(self.structure, self.document, self.located)
        declare_tables(self.structure, self.document, self.located, self.formulas)
        for name, coordinates in self.document.nodes.items():
            with self.located("nodes", name):
                self.structure.node(name, *(self.formulas.read(x) for x in coordinates))
        for name, table in self.document.elements.items():
            self.reader.element(name, table, self.node, self.structure.add)
        for name, table in self.document.meshes.items():
            self.reader.mesh(name, table, self.structure.add_mesh)
        self.on_nodes("supports", self.structure.support, DISPLACEMENTS)
        self.on_nodes("loads", self.structure.load, FORCES, "case", "fixed_axes")
        self.spread_loads()
        self.on_facets()
        self.on_nodes("initial", self.structure.initial, DISPLACEMENTS | VELOCITIES)
        return self.structure

    # elements --------------------------------------------------------------------------------
    def node(self, name: str, *where: str | int) -> Node:
        nodes = self.document.nodes
        if name not in nodes:
            raise self.located.error(unknown("node", name, nodes), *where)
        return self.structure.nodes[name]  # type: ignore[return-value]

    # supports and loads ----------------------------------------------------------------------
    def on_nodes(
        self, section: str, act: Callable, directions: dict[str, str], *plain: str
    ) -> None:
        """Call ``act(nodes, direction=value, …)`` for each table of a section."""
        for k, table in enumerate(getattr(self.document, section)):
            with self.located(section, k):
                options = self.reader.directed(table, directions, section, k)
                options |= {key: getattr(table, key) for key in plain}
                for nodes in self.selected(table, section, k):
                    act(nodes, **options)

    def spread_loads(self) -> None:
        """Apply gravity, line loads and temperatures."""
        for k, table in enumerate(self.document.gravity):
            with self.located("gravity", k):
                field = [self.formulas.read(x) for x in table.acceleration]
                self.structure.gravity(*field, case=table.case)
        loads: Any = {
            "line_loads": (self.structure.line_load, LINE_FORCES),
            "temperatures": (self.structure.heat, TEMPERATURES),
        }
        for section, (act, directions) in loads.items():
            for k, table in enumerate(getattr(self.document, section)):
                with self.located(section, k):
                    options = self.reader.directed(table, directions, section, k)
                    parts = [self.part(n, section, k, "elements") for n in table.elements]
                    act(parts, case=table.case, **options)

    def on_facets(self) -> None:
        """Apply tractions on edges and faces."""
        table: Any
        for k, table in enumerate(self.document.tractions):
            with self.located("tractions", k):
                options = self.reader.directed(table, TRACTIONS, "tractions", k)
                part = self.part(table.elements, "tractions", k, "elements")
                for nodes in self.selected(table, "tractions", k):
                    if not isinstance(nodes, Nodes):
                        raise ModelError(f"{nodes.name} is one node; take nodes of the mesh")
                    self.structure.traction(part, nodes, case=table.case, **options)

    def part(self, name: str, *where: str | int) -> Any:
        """The element or element set of this name."""
        elements = self.structure.elements
        if name not in elements:
            raise self.located.error(unknown("element", name, elements), *where)
        return elements[name]

    def selected(self, table: NodeChoice, section: str, k: int) -> list[Node | Nodes]:
        """The nodes that a table of supports or loads selects."""
        return [selected_nodes(self.nodes_named(name, section, k), table) for name in table.nodes]

    def nodes_named(self, name: str, section: str, k: int) -> Node | Nodes:
        """The node, the nodes of a mesh, or those of a group of it."""
        if name in self.document.nodes:
            return self.node(name)
        owner, _, group = name.partition(".")
        if owner in self.structure.meshes:
            with self.located(section, k, "nodes"):
                return self.structure.meshes[owner].nodes(group or None)
        candidates = [*self.document.nodes, *self.structure.meshes]
        candidates += [
            f"{mesh}.{g}" for mesh, m in self.structure.meshes.items() for g in m.selections
        ]
        raise self.located.error(unknown("nodes", name, candidates), section, k, "nodes")
