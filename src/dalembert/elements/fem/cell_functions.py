"""CasADi functions of finite elements in mechanisms, and graphs of elements whose nodes rotate.

A node of the latter is displaced by ``u`` and rotated by an angle, in space by a matrix ``R``,
without a limit of the rotation. Speeds are ``w = (u̇, ω)`` in fixed axes, in space not rates of
coordinates: with momenta ``(P, H) = ∂T/∂w`` and the angular velocity ``Ω`` of the inertia axes,

    δT = P·δu̇ + H·δω + δΘ·Σ (P × u̇ + H × ω),      δω = δφ̇ + δφ × ω,

the efforts are ``Ṗ`` on ``u̇``, ``Ḣ − ω × H`` on ``ω`` and ``Σ (u̇ × P + ω × H)`` on ``Ω``
(Boltzmann and Hamel). For a rigid body they are Newton's and Euler's equations.
"""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import Any

import casadi as ca

from dalembert.elements.fem.energies import Rows
from dalembert.elements.fem.graphs import ElementGraphs


class TurningGraphs(ElementGraphs):
    """Energies of one element between nodes with positions and rotations.

    Planar vectors are spatial ones normal to the z axis.
    """

    rotation_numbers = {3: 9}

    def _spin(self, u: ca.SX, v: ca.SX) -> ca.SX:
        return v[3:]

    @cached_property
    def rates(self) -> ca.SX:
        """``u̇`` and ``Ṙ = ω̃ R``."""
        if self.dimension == 2:
            return self.v
        parts = []
        for u, v in zip(self._u, self._v, strict=True):
            parts += [v[:3], ca.vec(ca.mtimes(ca.skew(v[3:]), ca.reshape(u[3:], 3, 3)))]
        return ca.vertcat(*parts)

    def slope(self, energy: ca.SX) -> ca.SX:
        """Gradient by displacements and by small rotations in fixed axes."""
        return ca.jtimes(self.rates, self.v, ca.gradient(energy, self.u), True)

    def spin_inertia(self) -> tuple[list[ca.SX], list[ca.SX]]:
        """Inputs (displacements, speeds, accelerations, data); efforts on speeds, Ω, effort on Ω.

        ``p = Q M Qᵀ w`` with the rotation ``Q`` of the axes, so that ``ṗ = Ω × p + Q M Qᵀ ẇ'`` with
        the relative derivative ``ẇ' = ẇ − Ω × w``. The computation is in these axes.
        """
        a, spin = ca.SX.sym("a", self.v.numel()), self._own_spin
        axes = self._inertia_axes
        local_spin, speeds, accelerations = (
            ca.mtimes(axes.T, x) for x in (spin, self._vectors(self.v), self._vectors(a))
        )
        momenta = self._momenta(speeds)
        relative = accelerations - _cross(local_spin, speeds)
        efforts = self._momenta(relative) + _cross(local_spin, momenta)
        pairs = zip(ca.horzsplit(speeds), ca.horzsplit(momenta), strict=True)
        products = ca.horzcat(*(_cross(w, p) for w, p in pairs))
        efforts[:, 1::2] = efforts[:, 1::2] - products[:, 1::2]  # moments
        effort, couple = (ca.mtimes(axes, x) for x in (efforts, ca.sum2(products)))
        return [self.u, self.v, a, self.data], [self._column(effort), spin, couple]

    @cached_property
    def _inertia_axes(self) -> ca.SX:
        """(3, 3) axes of its inertia."""
        if self.own_axes is None:
            return ca.SX.eye(3)
        return self.own_axes if self.dimension == 3 else ca.diagcat(self.own_axes, 1)

    def _momenta(self, speeds: ca.SX) -> ca.SX:
        """Momenta of speeds, as columns in the axes of the inertia."""
        energy = ca.SX(self.cls.kinetic_in_axes(self._v, self._x, self._q))
        return self._vectors(ca.mtimes(ca.hessian(energy, self.v)[0], self._column(speeds)))

    @cached_property
    def _own_spin(self) -> ca.SX:
        """Angular velocity of the axes of the inertia."""
        axes_rate = ca.jtimes(ca.vec(ca.densify(self._inertia_axes)), self.u, self.rates)
        return ca.inv_skew(ca.mtimes(ca.reshape(axes_rate, 3, 3), self._inertia_axes.T))

    def _vectors(self, column: ca.SX) -> ca.SX:
        """(3, 2 nodes) the translational and rotational vector of each node as columns."""
        if self.dimension == 3:
            return ca.reshape(column, 3, -1)
        parts = (
            ca.horzcat(ca.vertcat(node[:2], 0), ca.vertcat(0, 0, node[2]))
            for node in ca.vertsplit(column, 3)
        )
        return ca.horzcat(*parts)

    def _column(self, vectors: ca.SX) -> ca.SX:
        """The vectors as one column, the inverse of ``_vectors``."""
        if self.dimension == 3:
            return ca.vec(vectors)
        nodes = ca.horzsplit(vectors, 2)
        return ca.vertcat(*(ca.vertcat(node[:2, 0], node[2, 1]) for node in nodes))


def _cross(spin: ca.SX, columns: ca.SX) -> ca.SX:
    """``Ω ×`` each column."""
    return ca.mtimes(ca.skew(spin), columns)


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
    def mass_center(self) -> ca.Function | None:
        """``(u, data)`` → mass centre; None if it is that of the masses of the nodes."""
        g = self.graphs
        if g.mass_center is None:
            return None
        return ca.Function("mass_center", [g.u, g.data], [g.mass_center], {"cse": True})

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
