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
from dalembert.elements.fem.between_bodies import BetweenBodies
from dalembert.elements.fem.cell_functions import functions_of
from dalembert.elements.fem.energies import Energies
from dalembert.elements.fem.nodal import Nodal
from dalembert.elements.look import Strand
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression


class ElasticElement(ForceElement):
    """One or several finite elements; their nodes are bodies."""

    conservative = True

    @cached_property
    def between(self) -> list[BetweenBodies]:
        """The elements between the bodies at their nodes.

        Raises
        ------
        ModelError
            A node that cannot rotate, or whose stress-free position is missing.
        """
        raise NotImplementedError

    def parts(self) -> list[Coordinates]:
        return list(dict.fromkeys(node for e in self.between for node in e.nodes))  # type: ignore[misc]

    def powers(self, rate: Rate) -> Powers:
        return [pair for element in self.between for pair in element.powers(rate)]

    def potential(self) -> ca.SX:
        return sum((element.stored for element in self.between), ca.SX(0))

    def inertial_powers(self, rate: Rate) -> Powers:
        return [pair for element in self.between for pair in element.inertial_powers(rate)]

    def masses(self) -> list[tuple[ca.SX, ca.SX]]:
        return [share for element in self.between for share in element.masses()]

    def conditions(self) -> list[Condition]:
        own = (condition for element in self.between for condition in element.conditions())
        return [*super().conditions(), *own]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        energy = {"strain_energy": (self.potential(), "J")}
        return self.between[0].recovered() | energy if len(self.between) == 1 else energy

    def look(self) -> list[Look]:
        """Edges, each once."""
        edges = {frozenset((i.name, j.name)): (i, j) for e in self.between for i, j in e.edges()}
        return [Strand(i.center, j.center) for i, j in edges.values()]


@dataclass(eq=False)
class StructuralElement(Energies, ElasticElement):
    """A finite element between nodes."""

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

    @cached_property
    def between(self) -> list[BetweenBodies]:
        bodies = tuple(node.body for node in self.nodes())
        options = tuple(self.options().items())
        kind: Any = type(self)
        functions = functions_of(kind, bodies[0].dimension, len(bodies), options)
        numbers = [getattr(self, name).sx for name, _ in self.quantities()]
        return [BetweenBodies(self.name, functions, bodies, ca.vertcat(*numbers))]


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
