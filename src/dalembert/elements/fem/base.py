"""Base class of finite elements, for structures and mechanisms.

A new element is a dataclass with ``name`` first, then its nodes, then its quantities, and one class
method ``energy``, the strain energy of the displaced element, with ``kinetic`` if it has mass.
Internal forces ``∂W/∂u``, tangent stiffness ``∂²W/∂u²``, mass matrix and all design derivatives
follow by differentiation. Structures compile them once per kind of element and evaluate them for
all elements of the kind at once; in a mechanism they are part of its equations. If the inertia
rotates with the element, ``own_axes`` states its axes: inertia forces ``d/dt ∂T/∂v − ∂T/∂u`` follow
from the same kinetic energy.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from dalembert.elements.base import Condition, ForceElement, Look, Powers, Rate
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.fem.between_bodies import BetweenBodies, NodeBody
from dalembert.elements.fem.cell_functions import functions_of
from dalembert.elements.fem.energies import Energies
from dalembert.elements.fem.node import Nodal
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression


@dataclass(eq=False)
class StructuralElement(Energies, ForceElement):
    """A finite element between nodes of a structure, or between nodes that are bodies."""

    conservative = True

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, meta in self.quantities():
            as_expression(getattr(self, name), f"{self.name}.{name}", meta["unit"], meta["size"])
        check_options(self.name, self.options())

    def options(self) -> dict[str, bool]:
        """Values of the switches, which distinguish kinds of elements of one class."""
        fields = (f for f in dataclasses.fields(self) if f.metadata.get("kind") == "option")
        return {f.name: getattr(self, f.name) for f in fields}

    @classmethod
    def default_options(cls) -> dict[str, Any]:
        """Default values of the switches."""
        fields = (f for f in dataclasses.fields(cls) if f.metadata.get("kind") == "option")
        return {f.name: f.default for f in fields}

    def nodes(self) -> tuple[Nodal, ...]:
        """The nodes that it connects."""
        raise NotImplementedError

    # in a mechanism -----------------------------------------------------------------------
    @cached_property
    def between(self) -> BetweenBodies:
        """The element between bodies.

        Raises
        ------
        ModelError
            Its nodes are those of a structure.
        """
        nodes = self.nodes()
        bodies = [node for node in nodes if isinstance(node, NodeBody)]
        for node in nodes:
            if node not in bodies:
                raise ModelError(
                    f"{node.name!r} is a node of a structure; in a mechanism take "
                    "planar.PointNode, planar.Node, spatial.PointNode or spatial.Node, or add the "
                    "structure as a structures.ElasticStructure",
                    self.name,
                )
        options = tuple(self.options().items())
        kind: Any = type(self)
        functions = functions_of(kind, nodes[0].dimension, len(nodes), options)
        numbers = [getattr(self, name).sx for name, _ in self.quantities()]
        return BetweenBodies(self.name, functions, tuple(bodies), ca.vertcat(*numbers))

    def parts(self) -> list[Coordinates]:
        return [*self.between.nodes]  # type: ignore[list-item]

    def powers(self, rate: Rate) -> Powers:
        return self.between.powers(rate)

    def potential(self) -> ca.SX:
        return self.between.stored

    def inertial_powers(self, rate: Rate) -> Powers:
        return self.between.inertial_powers(rate)

    def masses(self) -> list[tuple[ca.SX, ca.SX]]:
        return self.between.masses()

    def conditions(self) -> list[Condition]:
        return [*super().conditions(), *self.between.conditions()]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        return {**self.between.recovered(), "strain_energy": (self.between.stored, "J")}

    def look(self) -> list[Look]:
        return self.between.look()


def check_options(entity: str, options: dict[str, Any]) -> None:
    """Check that switches are true or false.

    Raises
    ------
    ModelError
        A switch has another value.
    """
    for name, value in options.items():
        if not isinstance(value, bool):
            raise ModelError(f"must be True or False; got {value!r}", f"{entity}.{name}")
