"""What a structural element is.

To write a new one: a dataclass with ``name`` first, then its nodes, then its numbers as
``quantity``; and one class method ``energy``, the strain energy of the displaced element. Internal
forces ``∂W/∂u``, tangent stiffness ``∂²W/∂u²`` and all design derivatives follow by
differentiation, once per kind of element, and are evaluated for all elements of the kind at once.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Element
from dalembert.structures.node import Node


@dataclass(eq=False)
class StructuralElement(Element):
    """An element between nodes."""

    turns: ClassVar[bool] = False
    """Whether its nodes have rotations too."""

    def options(self) -> dict[str, bool]:
        """Switches, which make elements of one class different kinds."""
        fields = (f for f in dataclasses.fields(self) if f.metadata.get("kind") == "option")
        return {f.name: getattr(self, f.name) for f in fields}

    def nodes(self) -> tuple[Node, ...]:
        """The nodes it ties together."""
        raise NotImplementedError

    @classmethod
    def energy(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """Strain energy ``W`` [J].

        Parameters
        ----------
        u : displacements (and rotations) of the nodes
        x : positions of the nodes
        q : quantities of the element by field name
        """
        raise NotImplementedError

    @classmethod
    def measures(
        cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]
    ) -> dict[str, tuple[ca.SX, str]]:
        """Named quantities of the displaced element: name → (expression, unit)."""
        return {}

    @classmethod
    def mass(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """Mass of the element [kg]."""
        return ca.SX(0)
