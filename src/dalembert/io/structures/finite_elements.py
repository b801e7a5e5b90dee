"""Finite elements, meshes, supports and loads in the file of a mechanism."""

from __future__ import annotations

from typing import Any

from dalembert.elements.fem.between_bodies import NodeBody
from dalembert.io.schema import Document
from dalembert.io.structures.mesh_reader import MeshReader, narrowed
from dalembert.io.structures.tables import DISPLACEMENTS, FORCES, NodeChoice
from dalembert.model.system import System
from dalembert.structures.elastic_structure import ElasticStructure
from dalembert.text.wording import unknown


class FiniteElements:
    """Adds them to a system whose bodies are there already.

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
        """Elements between nodes, and meshes."""
        for name, table in self.document.elements.items():
            self.reader.element(name, table, self.node, self.system.add)
        for name, table in self.document.meshes.items():
            self.reader.mesh(name, table, self.system.add_mesh)

    def hold(self) -> None:
        """Supports and loads."""
        acts = {
            "supports": (self.system.support, DISPLACEMENTS),
            "loads": (self.system.load, FORCES),
        }
        for section, (act, directions) in acts.items():
            table: Any
            for k, table in enumerate(getattr(self.document, section)):
                with self.located(section, k):
                    given = self.reader.directed(table, directions, section, k)
                    act(self.chosen(table, section, k), **given)

    def node(self, name: str, *where: str | int) -> NodeBody:
        """The body of this name, which must be a node."""
        known = {n: b for n, b in self.system.elements.items() if isinstance(b, NodeBody)}
        meshes = self.document.meshes if "connect" not in where else ()
        if name not in known:
            if name in self.document.bodies:
                text = f'{name!r} is no node; give it type = "Node" or "PointNode"'
                raise self.located.error(text, *where)
            raise self.located.error(unknown("node", name, [*known, *meshes]), *where)
        return known[name]

    def chosen(self, table: NodeChoice, section: str, k: int) -> list[NodeBody]:
        """The nodes that a table of supports or loads means."""
        found: list[NodeBody] = []
        for name in table.nodes:
            owner, _, group = name.partition(".")
            if owner in self.document.meshes:
                with self.located(section, k, "nodes"):
                    found += self.of_mesh(owner, group, table)
                continue
            found.append(narrowed(self.node(name, section, k, "nodes"), table))
        return found

    def of_mesh(self, owner: str, group: str, table: NodeChoice) -> list[NodeBody]:
        """All nodes of a mesh, one by its name or those of a group, narrowed down."""
        made = self.system.elements[owner]
        assert isinstance(made, ElasticStructure)
        if group in made.named_nodes:
            return [made.named_nodes[group]]
        return made.at(narrowed(made.mesh.nodes(group or None), table))
