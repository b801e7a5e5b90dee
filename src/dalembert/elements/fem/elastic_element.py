"""Finite elements between bodies as forces of a mechanism: one element, or those of a set."""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.elements.base import Condition, ForceElement, Look, Powers, Rate
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.fem.between_bodies import BetweenBodies
from dalembert.elements.look import Strand


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
