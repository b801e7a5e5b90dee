"""Nodes, finite elements, meshes, supports and loads of a model file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.elements.fem.between_bodies import NodeBody
from dalembert.elements.fem.node import Node
from dalembert.elements.fem.node_set import Nodes
from dalembert.elements.fem.registry import ELEMENTS, cell_of
from dalembert.errors import ModelError
from dalembert.io.fields import FileField, Quantities, Quantity, connected_fields, read_fields
from dalembert.io.finite_element_tables import (
    DISPLACEMENTS,
    FORCES,
    LINE_FORCES,
    TEMPERATURES,
    TRACTIONS,
    VELOCITIES,
    NodeChoice,
)
from dalembert.io.formulas import Formulas, Scope
from dalembert.io.laws_and_curves import construct
from dalembert.io.location import Located
from dalembert.io.schema import ModelDocument
from dalembert.model.meshes.generators import box_mesh, line_mesh, rectangle_mesh
from dalembert.model.system import System
from dalembert.text.wording import unknown

NodeOrNodes = Node | NodeBody | Nodes
"""A node, a body that is a node, or a set of nodes."""


class FiniteElements:
    """Reader of the finite elements of a document, and of the conditions on them.

    Parameters
    ----------
    document : ModelDocument
    system : builder that has the bodies of the document
    located : for messages
    formulas : reads numbers
    """

    def __init__(
        self, document: ModelDocument, system: System, located: Located, formulas: Formulas
    ):
        self.document, self.system = document, system
        self.located, self.formulas = located, formulas
        self.source: Path = located.source

    def add(self) -> None:
        """Add nodes, elements between them, and meshes."""
        for name, coordinates in self.document.nodes.items():
            with self.located("nodes", name):
                self.system.node(name, *(self.formulas.read(x) for x in coordinates))
        for name, table in self.document.elements.items():
            self.element(name, table)
        for name, table in self.document.meshes.items():
            self.mesh(name, table)

    def add_conditions(self) -> None:
        """Add supports, loads and initial motions of nodes."""
        self.on_nodes("supports", self.system.support, DISPLACEMENTS)
        self.on_nodes("loads", self.system.load, FORCES, "case", "fixed_axes")
        self.gravity()
        self.on_elements("line_loads", self.system.line_load, LINE_FORCES)
        self.on_elements("temperatures", self.system.heat, TEMPERATURES)
        self.on_facets()
        if isinstance(self.document.initial, list):
            self.on_nodes("initial", self.system.initial, DISPLACEMENTS | VELOCITIES)

    # elements --------------------------------------------------------------------------------
    def element(self, name: str, table: Any) -> None:
        cls, where = ELEMENTS[table.type], ("elements", name)
        with self.located(*where):
            ends = enumerate(table.connect)
            nodes = [self.node(end, *where, "connect", k) for k, end in ends]
            connections = [tuple(nodes)] if len(connected_fields(cls)) < len(nodes) else nodes
            keys = read_fields(cls, table, self.located, where, self.value)
            self.system.add(construct(cls, name, *connections, **keys))

    def mesh(self, name: str, table: Any) -> None:
        cls, where = ELEMENTS[table.type], ("meshes", name)
        shape = cell_of(cls)
        with self.located(*where):
            keys = read_fields(cls, table, self.located, where, self.value)
            mesh = self.mesh_source(table, shape, where)
            self.system.add_mesh(name, mesh, {shape: cls}, **keys)

    def value(self, field: FileField, entry: Any, where: tuple[str, ...]) -> Any:
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
            "polygon": lambda: self.polygon(table.polygon, shape),
        }
        keys = [key for key in makers if getattr(table, key) is not None]
        if len(keys) != 1:
            listed = ", ".join(keys) or "none"
            raise self.located.error(f"give one of {', '.join(makers)}; got {listed}", *where)
        with self.located(*where, keys[0]):
            return makers[keys[0]]()

    def points(self, table: Any, shape: str, where: tuple[str, ...]) -> Any:
        """Points and cells written in the file."""
        if table.cells is None:
            raise self.located.error("is missing; points need cells", *where, "cells")
        if len({len(r) for r in table.points}) != 1 or len({len(c) for c in table.cells}) != 1:
            raise ModelError("rows have different lengths")
        points = [[self.formulas.read(x) for x in coordinates] for coordinates in table.points]
        flat = _array([x for coordinates in points for x in coordinates])
        return flat.reshape(len(points), -1), {shape: np.array(table.cells)}

    def polygon(self, table: Any, shape: str) -> Any:
        """Triangles of a region; numbers of its boundary may be formulas."""
        from dalembert.model.meshes.polygon import polygon_mesh  # few files have regions

        def places(rows: Any) -> list[Any]:
            return [[self.formulas.read(x) for x in row] for row in rows]

        holes = [
            places(hole)
            if isinstance(hole, list)
            else (*places([hole.center]), self.formulas.read(hole.radius))
            for hole in table.holes
        ]
        outline, known = places(table.vertices), self.system.parameters
        return polygon_mesh(outline, table.size, holes, shape, known)

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

    # conditions ------------------------------------------------------------------------------
    def on_nodes(
        self, section: str, act: Callable, directions: dict[str, str], *plain: str
    ) -> None:
        """Call ``act(nodes, direction=value, …)`` for each table of a section."""
        for k, table in enumerate(getattr(self.document, section)):
            with self.located(section, k):
                options = self.directed(table, directions, section, k)
                options |= {key: getattr(table, key) for key in plain}
                for nodes in self.selected(table, section, k):
                    act(nodes, **options)

    def on_elements(self, section: str, act: Callable, directions: dict[str, str]) -> None:
        """Call ``act(elements, case, direction=value, …)`` for each table of a section."""
        for k, table in enumerate(getattr(self.document, section)):
            with self.located(section, k):
                options = self.directed(table, directions, section, k)
                parts = [self.part(name, section, k, "elements") for name in table.elements]
                act(parts, case=table.case, **options)

    def gravity(self) -> None:
        fields = self.document.gravity or []
        if fields and not hasattr(fields[0], "acceleration"):
            with self.located("gravity"):
                self.system.gravity(*(self.formulas.read(g) for g in fields))
            return
        for k, table in enumerate(fields):
            with self.located("gravity", k):
                field = [self.formulas.read(x) for x in table.acceleration]
                self.system.gravity(*field, case=table.case)

    def on_facets(self) -> None:
        """Apply tractions on edges and faces."""
        table: Any
        for k, table in enumerate(self.document.tractions):
            with self.located("tractions", k):
                options = self.directed(table, TRACTIONS, "tractions", k)
                part = self.part(table.elements, "tractions", k, "elements")
                for nodes in self.selected(table, "tractions", k):
                    if not isinstance(nodes, Nodes):
                        raise ModelError(f"{nodes.name} is one node; take nodes of the mesh")
                    self.system.traction(part, nodes, case=table.case, **options)

    # names -----------------------------------------------------------------------------------
    @property
    def single_nodes(self) -> Mapping[str, NodeOrNodes]:
        """Nodes of the document, and bodies that are nodes."""
        bodies = {n: b for n, b in self.system.elements.items() if isinstance(b, NodeBody)}
        return bodies | {name: self.system.nodes[name] for name in self.document.nodes}

    def node(self, name: str, *where: str | int, more: tuple[str, ...] = ()) -> NodeOrNodes:
        """The node of this name; ``more`` are further known names."""
        nodes = self.single_nodes
        if name not in nodes:
            if name in getattr(self.document, "bodies", {}):
                text = f'{name!r} is no node; give it type = "Node" or "PointNode"'
                raise self.located.error(text, *where)
            raise self.located.error(unknown("node", name, [*nodes, *more]), *where)
        return nodes[name]

    def part(self, name: str, *where: str | int) -> Any:
        """The element or element set of this name."""
        elements = self.system.elements
        if name not in elements:
            raise self.located.error(unknown("element", name, elements), *where)
        return elements[name]

    def selected(self, table: NodeChoice, section: str, k: int) -> list[NodeOrNodes]:
        """The nodes that a table of supports or loads selects."""
        return [selected_nodes(self.nodes_named(name, section, k), table) for name in table.nodes]

    def nodes_named(self, name: str, section: str, k: int) -> NodeOrNodes:
        """The node, the nodes of a mesh, or those of a group of it."""
        owner, _, group = name.partition(".")
        meshes = self.system.meshes
        if owner in meshes:
            try:
                return meshes[owner].nodes(group or None)
            except ModelError as error:
                raise self.located.error(error.message, section, k, "nodes") from None
        groups = [f"{mesh}.{g}" for mesh, m in meshes.items() for g in m.selections]
        return self.node(name, section, k, "nodes", more=(*meshes, *groups))


def selected_nodes(nodes: NodeOrNodes, table: NodeChoice) -> NodeOrNodes:
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
