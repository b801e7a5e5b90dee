"""One finite element as CasADi functions that are summed over its points of integration."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import Any

import casadi as ca

from dalembert.elements.fem.energies import Rows
from dalembert.elements.fem.graphs import ElementGraphs
from dalembert.elements.fem.turning_graphs import TurningGraphs


class CellFunctions:
    """What a mechanism asks of an element, for symbols that are expressions of its own.

    Parameters
    ----------
    graphs : of the kind of element
    """

    def __init__(self, graphs: ElementGraphs):
        self.graphs = graphs

    @property
    def massless(self) -> bool:
        return bool(self.graphs.kinetic.is_zero())

    @cached_property
    def stored(self) -> ca.Function:
        """``(u, data)`` → strain energy and internal forces."""
        g = self.graphs
        energy = self._summed(g.whole_energy, g.cls.samples)
        return ca.Function("stored", [g.u, g.data], [energy, g.slope(energy)], {"cse": True})

    @cached_property
    def inertia(self) -> ca.Function:
        """``(u, v, a, data)`` → ``d/dt ∂T/∂v − ∂T/∂u``."""
        inputs, force = self.graphs.inertia_force("consistent")
        return ca.Function(
            "inertia", inputs, [self._summed(force, self.graphs.cls.kinetic_samples)]
        )

    @property
    def by_spins(self) -> bool:
        """Whether speeds are velocities and spins of nodes: where they turn."""
        return isinstance(self.graphs, TurningGraphs)

    @cached_property
    def taken(self) -> ca.Function:
        """Of nodes that turn: see ``TurningGraphs.taken``."""
        assert isinstance(self.graphs, TurningGraphs)
        inputs, outputs = self.graphs.taken()
        points = self.graphs.cls.kinetic_samples
        summed = [self._summed(out, points) for out in (outputs[0], outputs[2])]
        return ca.Function("taken", inputs, [summed[0], outputs[1], summed[1]], {"cse": True})

    @cached_property
    def shares(self) -> ca.Function:
        """``data`` → mass of each node, by the momentum of all of them along x."""
        g = self.graphs
        per_node = g.v.numel() // g.node_count
        energy = self._summed(g.kinetic, g.cls.kinetic_samples)
        along = ca.vertcat(*([1, *[0] * (per_node - 1)] * g.node_count))
        momentum = ca.substitute(ca.gradient(energy, g.v), g.v, along)
        return ca.Function("shares", [g.data], [momentum[::per_node]])

    @cached_property
    def checks(self) -> list[tuple[ca.Function, str]]:
        """``data`` → what must be positive, everywhere in the element; what is wrong if not."""
        g = self.graphs
        return [
            (ca.Function("check", [g.data], [self._at(value, point)]), wrong)
            for value, wrong in g.checks
            for point in g.cls.samples
        ]

    @cached_property
    def recovered(self) -> ca.Function:
        """``(u, data)`` → the measures of the element, where they are taken by default."""
        g = self.graphs
        values = [self._at(value, g.cls.stations[""]) for value, _ in g.measures.values()]
        return ca.Function("recovered", [g.u, g.data], values)

    def _summed(self, value: ca.SX, points: Rows) -> ca.SX:
        return sum((self._at(value, point) for point in points), ca.SX(0))

    def _at(self, value: ca.SX, point: tuple[float, ...]) -> ca.SX:
        """The value at a point of integration."""
        at = self.graphs.at
        return ca.substitute(value, at, ca.SX(list(point))) if at.numel() else value


@lru_cache
def functions_of(
    cls: Any, dimension: int, node_count: int, options: tuple[tuple[str, Any], ...]
) -> CellFunctions:
    """Those of a kind of element, which are made once."""
    graphs = TurningGraphs if cls.turns else ElementGraphs
    return CellFunctions(graphs(cls, dimension, node_count, dict(options)))
