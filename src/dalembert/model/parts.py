"""Nodes and elements of a structure, with unique names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np

from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.node import ROTATIONS, TRANSLATIONS, Node
from dalembert.elements.fem.sets import Elements, Nodes
from dalembert.errors import ModelError
from dalembert.model.assembled.evaluation.numbering import Spans
from dalembert.model.assembled.loads.load_records import check_temperature
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.declared import Declared
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.interpolation import Interpolation
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.text.wording import card, plain_text, table

MOST = 20
"""Upper limit of the elements listed in a notebook."""
S = TypeVar("S", bound=StructuralElement)


class StructureParts(Declared):
    """Parameters, nodes and elements.

    Parameters
    ----------
    name : str
    description : str
    """

    def __init__(self, name: str, description: str = ""):
        self.name = plain_text(name, "name of the structure")
        self.description = plain_text(description, "description of the structure")
        self.parameters: dict[str, Parameter] = {}
        self.tables: dict[str, Interpolation] = {}
        self.nodes: dict[str, Node | Nodes] = {}
        self.numbers = Spans()
        self.elements: dict[str, StructuralElement | Elements] = {}

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name!r}: {self._counted}>"

    def _repr_html_(self) -> str:
        rows = [(part.name, _kind(part)) for part in self.elements.values()]
        listed = table(rows[:MOST], ("element", "kind"))
        return card(f"{type(self).__name__} {self.name}", self._counted, listed)

    @property
    def _counted(self) -> str:
        nodes = sum(len(n) if isinstance(n, Nodes) else 1 for n in self.nodes.values())
        elements = sum(len(e) if isinstance(e, Elements) else 1 for e in self.elements.values())
        return f"{nodes} nodes, {elements} elements, {len(self.parameters)} parameters"

    def node(self, name: str, *position) -> Node:
        """Add a node at coordinates [m]; all nodes have the same number of coordinates."""
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

    def add(self, element: S) -> S:
        """Add an element; returns it."""
        if not isinstance(element, StructuralElement):
            raise ModelError(f"add() takes a structural element, got {element!r}", self.name)
        self._claim(element.name)
        for node in element.nodes():
            if self.nodes.get(node.name) is not node:
                raise ModelError(
                    f"is tied to {node.name!r}, which is no node of this structure; add it with "
                    "structure.node(...)",
                    element.name,
                )
        check_temperature(element)
        self.elements[element.name] = element
        return element

    def add_elements(
        self, name: str, cls: type[StructuralElement], nodes: Nodes, cells, **numbers: Any
    ) -> Elements:
        """Add a set of elements of one class.

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
        self.elements[name] = elements
        return elements

    @property
    def dimension(self) -> int:
        """Number of coordinates of the nodes."""
        return next((n.dimension for n in self.nodes.values()), 1)

    def _check_nodes(self, node: Node | Nodes) -> None:
        if not isinstance(node, (Node, Nodes)):
            raise ModelError(f"expected nodes of the structure, got {node!r}", self.name)
        present = self.nodes.get(node.name)
        if isinstance(present, Nodes) and isinstance(node, Nodes) and present.points is node.points:
            return  # a selection of a set
        if present is not node:
            raise ModelError("is no node of this structure", node.name)

    def _directions(self, node: Node | Nodes) -> tuple[str, ...]:
        self._check_nodes(node)
        return TRANSLATIONS[: node.dimension] + ROTATIONS[node.dimension]

    def _names(self, node: Node | Nodes) -> list[str]:
        return node.names if isinstance(node, Nodes) else [node.name]

    def _numbers(self, node: Node | Nodes) -> np.ndarray:
        first = self.numbers.first(node.name)
        return first + node.index if isinstance(node, Nodes) else np.array([first])

    @staticmethod
    def _each(node: Node | Nodes, value: Any) -> Any:
        """One value per node."""
        count = len(node) if isinstance(node, Nodes) else 1
        if isinstance(value, Expression) or np.ndim(value) != 1:
            return [value] * count
        if len(value) != count:
            raise ModelError(f"has {count} node(s), got {len(value)} values", node.name)
        return value

    def _check_dimension(self, node: Node | Nodes) -> None:
        for other in self.nodes.values():
            if other.dimension != node.dimension:
                raise ModelError(
                    f"has {node.dimension} coordinates, {other.name} has {other.dimension}",
                    node.name,
                )
            return  # all others agree with the first

    @staticmethod
    def _check_direction(node: Node | Nodes, direction: str, known) -> None:
        if direction not in known:
            raise ModelError(
                f"unknown direction {direction!r}; known: {', '.join(known)}", node.name
            )

    def _vector(self, entity: str, values, unit: str) -> tuple[Expression, ...]:
        if len(values) != self.dimension:
            raise ModelError(f"needs {self.dimension} numbers, got {len(values)}", entity)
        return tuple(as_expression(v, entity, unit) for v in values)

    @property
    def _parts(self) -> tuple[Mapping[str, Any], ...]:
        return self.nodes, self.elements


def _kind(part: StructuralElement | Elements) -> str:
    return f"{len(part)} {part.cls.__name__}" if isinstance(part, Elements) else type(part).__name__
