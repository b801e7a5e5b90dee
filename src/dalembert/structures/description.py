"""What a structure consists of, checked as it is put together."""

from __future__ import annotations

from dalembert.errors import ModelError
from dalembert.structures.base import StructuralElement
from dalembert.structures.node import ROTATIONS, TRANSLATIONS, Node
from dalembert.symbolic.expression import Expression, as_expression
from dalembert.symbolic.parameter import Parameter


class StructureDescription:
    """Nodes, elements between them, supports and loads; the builder fills it.

    Every number may be a formula of parameters.

    Parameters
    ----------
    name : str
    description : str
    """

    def __init__(self, name: str, description: str = ""):
        self.name, self.description = name, description
        self.parameters: dict[str, Parameter] = {}
        self.nodes: dict[str, Node] = {}
        self.elements: dict[str, StructuralElement] = {}
        self.supports: dict[tuple[str, str], Expression] = {}
        self.fixed: list[str] = []
        self.loads: dict[str, list[tuple[str, str, Expression]]] = {}

    def parameter(
        self, name: str, value: float, unit: str = "", bounds=None, description: str = ""
    ) -> Parameter:
        """Declare a parameter; use it in formulas wherever a number is accepted."""
        self._claim(name)
        made = Parameter(name, value, unit, bounds, description)
        self.parameters[name] = made
        return made

    def node(self, name: str, *position) -> Node:
        """Add a node at the given coordinates [m]; all nodes have the same number of them."""
        self._claim(name)
        made = Node(name, position)
        for other in self.nodes.values():
            if other.dimension != made.dimension:
                raise ModelError(
                    f"has {made.dimension} coordinates, {other.name} has {other.dimension}", name
                )
        self.nodes[name] = made
        return made

    def add(self, element: StructuralElement):
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
        self.elements[element.name] = element
        return element

    def support(self, node: Node, **displacements) -> None:
        """Prescribe displacements of a node, e.g. ``ux=0, uy=0.01`` [m], ``rz=0`` [rad].

        Without any, all displacements are zero.
        """
        known = self._directions(node)
        if not displacements:
            self.fixed.append(node.name)
        for direction, value in displacements.items():
            self._check_direction(node, direction, known)
            if (node.name, direction) in self.supports:
                raise ModelError(
                    f"{direction} is prescribed twice; support it once", f"support {node.name}"
                )
            made = as_expression(value, f"support {node.name}.{direction}", "m")
            self.supports[node.name, direction] = made

    def load(self, node: Node, case: str = "", **forces) -> None:
        """Add forces and moments at a node, e.g. ``fx=10, fy=-3`` [N], ``mz=2`` [N m].

        Loads at one node add up. ``case`` names a load case.
        """
        for direction, value in forces.items():
            motion = direction.replace("f", "u", 1).replace("m", "r", 1)
            self._check_direction(node, motion, self._directions(node), direction)
            made = as_expression(value, f"load {node.name}.{direction}", "N")
            self.loads.setdefault(case, []).append((node.name, motion, made))

    @property
    def dimension(self) -> int:
        """Of space."""
        return next((n.dimension for n in self.nodes.values()), 1)

    def _directions(self, node: Node) -> tuple[str, ...]:
        if self.nodes.get(node.name) is not node:
            raise ModelError("is no node of this structure", node.name)
        return TRANSLATIONS[: node.dimension] + ROTATIONS[node.dimension]

    @staticmethod
    def _check_direction(node: Node, direction: str, known, written: str = "") -> None:
        if direction not in known:
            raise ModelError(
                f"unknown direction {written or direction!r}; known: {', '.join(known)}", node.name
            )

    def _claim(self, name: str) -> None:
        if name in self.parameters or name in self.nodes or name in self.elements:
            raise ModelError("the name is already used; choose a different one", name)
