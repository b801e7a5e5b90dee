"""CasADi functions of one finite element in a mechanism, summed over its integration points."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import Any

import casadi as ca

from dalembert.elements.fem.energies import Rows
from dalembert.elements.fem.graphs import ElementGraphs
from dalembert.elements.fem.turning_graphs import TurningGraphs


class CellFunctions:
    """Functions of an element for the equations of a mechanism.

    Parameters
    ----------
    graphs : expression graphs of the kind of element
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
        """Whether speeds are velocities and angular velocities, for nodes that rotate."""
        return isinstance(self.graphs, TurningGraphs)

    @cached_property
    def spin_inertia(self) -> ca.Function:
        """Inertia efforts of nodes that rotate, see ``TurningGraphs.spin_inertia``."""
        assert isinstance(self.graphs, TurningGraphs)
        inputs, outputs = self.graphs.spin_inertia()
        points = self.graphs.cls.kinetic_samples
        summed = [self._summed(out, points) for out in (outputs[0], outputs[2])]
        return ca.Function(
            "spin_inertia", inputs, [summed[0], outputs[1], summed[1]], {"cse": True}
        )

    @cached_property
    def shares(self) -> ca.Function:
        """``data`` → mass of each node, from its momentum at unit velocity along x."""
        g = self.graphs
        per_node = g.v.numel() // g.node_count
        energy = self._summed(g.kinetic, g.cls.kinetic_samples)
        velocity = ca.vertcat(*([1, *[0] * (per_node - 1)] * g.node_count))
        momentum = ca.substitute(ca.gradient(energy, g.v), g.v, velocity)
        return ca.Function("shares", [g.data], [momentum[::per_node]])

    @cached_property
    def checks(self) -> list[tuple[ca.Function, str]]:
        """(``data`` → value that must be positive, message) at every sample."""
        g = self.graphs
        return [
            (ca.Function("check", [g.data], [self._at(value, point)]), wrong)
            for value, wrong in g.checks
            for point in g.cls.samples
        ]

    @cached_property
    def recovered(self) -> ca.Function:
        """``(u, data)`` → the measures of the element at their default station."""
        g = self.graphs
        values = [self._at(value, g.cls.stations[""]) for value, _ in g.measures.values()]
        return ca.Function("recovered", [g.u, g.data], values)

    def _summed(self, value: ca.SX, points: Rows) -> ca.SX:
        return sum((self._at(value, point) for point in points), ca.SX(0))

    def _at(self, value: ca.SX, point: tuple[float, ...]) -> ca.SX:
        """The value at an integration point."""
        at = self.graphs.at
        return ca.substitute(value, at, ca.SX(list(point))) if at.numel() else value


@lru_cache
def functions_of(
    cls: Any, dimension: int, node_count: int, options: tuple[tuple[str, Any], ...]
) -> CellFunctions:
    """Functions of a kind of element, cached."""
    graphs = TurningGraphs if cls.turns else ElementGraphs
    return CellFunctions(graphs(cls, dimension, node_count, dict(options)))
