"""Nodes and elements of a model under construction, with unique names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, TypeVar

import numpy as np

from dalembert.elements.base import Element
from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.between_bodies import NodeBody
from dalembert.elements.fem.element_set import Elements
from dalembert.elements.fem.node import Node, RigidMotion
from dalembert.elements.fem.node_set import Nodes
from dalembert.elements.planar.body import Ground
from dalembert.errors import ModelError
from dalembert.model.load_records import check_temperature
from dalembert.model.meshes.mesh import Classes, Mesh, add_mesh
from dalembert.model.spans import Spans
from dalembert.symbolic.formulas.declared import Declared, check_free, parameter_table
from dalembert.text.wording import card, counted, table

ELEMENT_MEANINGS = {"ground": "the body at rest"}
"""Reserved names of elements, with their meaning."""
MOST = 20
"""Upper limit of the elements listed in a notebook."""
E = TypeVar("E", bound=Element)


class Parts(Declared):
    """Parameters, nodes, elements and meshes.

    Parameters
    ----------
    name : str
    description : str

    Attributes
    ----------
    ground : the body at rest
    nodes : name → node or set of nodes
    elements : name → element or set of elements; bodies, joints and forces, too
    meshes : name → Mesh
    numbers : numbers of the nodes
    """

    reserved: ClassVar[Mapping[str, str]] = ELEMENT_MEANINGS
    """Reserved names of elements and nodes, with their meaning."""

    def __init__(self, name: str, description: str = ""):
        super().__init__(name, description)
        self.ground = Ground()
        self.nodes: dict[str, Node | Nodes] = {}
        self.elements: dict[str, Element] = {}
        self.meshes: dict[str, Mesh] = {}
        self.numbers = Spans()

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name!r}: {self._counted}>"

    def _repr_html_(self) -> str:
        rows = [(part.name, _kind(part)) for part in self.elements.values()]
        parts = (table(rows[:MOST], ("element", "kind")), parameter_table(self.parameters))
        return card(f"{type(self).__name__} {self.name}", self._counted, *parts)

    @property
    def _counted(self) -> str:
        nodes = sum(len(n) if isinstance(n, Nodes) else 1 for n in self.nodes.values())
        elements = sum(len(e) if isinstance(e, Elements) else 1 for e in self.elements.values())
        parts = [counted(nodes, "node")] if nodes else []
        parts += [counted(elements, "element"), counted(len(self.parameters), "parameter")]
        return ", ".join(parts)

    def node(self, name: str, *position) -> Node:
        """Add a node of finite elements at coordinates [m].

        All nodes have the same number of coordinates.
        """
        self._claim(name)
        node = Node(name, position)
        self._check_dimension(node)
        self.numbers.add(name)
        self.nodes[name] = node
        return node

    def add_nodes(self, name: str, points) -> Nodes:
        """Add a set of nodes at ``points`` (count, d) [m], numbers or formulas."""
        self._claim(name)
        nodes = Nodes(name, points)
        self._check_dimension(nodes)
        self.numbers.add(name, len(nodes))
        self.nodes[name] = nodes
        return nodes

    def add(self, element: E) -> E:
        """Add a body, joint, driver, force or finite element; returns it."""
        if not isinstance(element, Element) or isinstance(element, Node):
            raise ModelError(f"add() takes an element, got {element!r}", self.name)
        if isinstance(element, StructuralElement):
            self._tie(element)
        self._claim(element.name)
        self.elements[element.name] = element
        return element

    def _tie(self, element: StructuralElement) -> None:
        """Check the nodes of a finite element, and let those rotate that it rotates."""
        for node in element.nodes():
            if isinstance(node, Node) and self.nodes.get(node.name) is not node:
                raise ModelError(
                    f"is tied to {node.name!r}, which is no node of this model; add it with "
                    "node(...)",
                    element.name,
                )
        check_temperature(element)
        for node in element.nodes():
            if element.turns and isinstance(node, Node):
                node.rotate(element.name)

    def add_elements(
        self, name: str, cls: type[StructuralElement], nodes: Nodes, cells, **numbers: Any
    ) -> Elements:
        """Add a set of finite elements of one class.

        Parameters
        ----------
        name : of the set; its elements are called ``name[k]``
        cls : class of the elements
        nodes : the nodes that ``cells`` refers to
        cells : (count, nodes of an element) indices within ``nodes``
        **numbers : quantities of the class, for all or an array with one per element; options
        """
        self._claim(name)
        self._check_nodes(nodes)
        elements = Elements(name, cls, nodes, cells, **numbers)
        check_temperature(elements)
        if cls.turns:
            nodes.rotate(np.unique(nodes.index[elements.cells]), name)
        self.elements[name] = elements
        return elements

    def add_mesh(
        self,
        name: str,
        mesh: Any,
        element: Classes = None,
        *,
        velocity: Any = None,
        angular_velocity: Any = None,
        **quantities: Any,
    ) -> Mesh:
        """Add the nodes and elements of a mesh.

        Nodes are called ``name_nodes[k]``, elements ``name[k]`` (``name_shape[k]`` where cells of
        several shapes become elements). Points in the plane ``z = 0`` get two coordinates; points
        without elements are omitted; cells of lower dimension, such as the edges of an area, only
        serve as groups of nodes. In a mechanism every node is a body: use a ``FlexibleBody`` for a
        fine mesh.

        Parameters
        ----------
        name : of the mesh
        mesh : meshio.Mesh, path of a file that meshio reads, or ``(points, cells)`` with cells an
            array (cells, nodes) or a table of such arrays by shape
        element : class of the elements, or a table of classes by shape; by default chosen by shape
            and dimension, except for lines
        velocity, angular_velocity : of the whole mesh at the start of a mechanism's motion, the
            latter about the origin [m/s], [rad/s]
        **quantities : of the elements: a number or formula for all, an array with one per element,
            or a table with one per group of elements; options

        Raises
        ------
        ModelError, FileError, UnsupportedError
            Not a mesh, an element that does not fit its cells, meshio missing.
        """
        added = add_mesh(self, name, mesh, element, quantities)
        self.meshes[name] = added
        if velocity is not None or angular_velocity is not None:
            nodes = added.nodes()
            nodes.motion = RigidMotion.of(name, nodes.dimension, velocity, angular_velocity)
        return added

    @property
    def dimension(self) -> int:
        """Number of coordinates of the nodes."""
        return next((n.dimension for n in self.nodes.values()), 1)

    def _check_nodes(self, node: Node | Nodes | NodeBody) -> None:
        """Check that a node, or a set or selection of nodes, belongs to this model."""
        if isinstance(node, NodeBody):
            return  # the check of all elements includes bodies
        if not isinstance(node, (Node, Nodes)):
            raise ModelError(
                f"expected nodes, got {node!r}; other bodies are held by joints and loaded by "
                "forces",
                self.name,
            )
        present = self.nodes.get(node.name)
        if isinstance(present, Nodes) and isinstance(node, Nodes) and present.points is node.points:
            return  # a selection of a set
        if present is not node:
            raise ModelError("is no node of this model", node.name)

    def _check_dimension(self, node: Node | Nodes) -> None:
        for other in self.nodes.values():
            if other.dimension != node.dimension:
                raise ModelError(
                    f"has {node.dimension} coordinates, {other.name} has {other.dimension}",
                    node.name,
                )
            return  # all others agree with the first

    def _claim(self, name: str) -> None:
        check_free(name, self.reserved, self.name, "mechanisms")
        super()._claim(name)

    @property
    def _parts(self) -> tuple[Mapping[str, Any], ...]:
        return self.nodes, self.elements


def _kind(part: Element) -> str:
    return f"{len(part)} {part.cls.__name__}" if isinstance(part, Elements) else type(part).__name__
