"""Expression graphs and CasADi functions of one kind of finite element."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from dalembert.elements.fem.energies import Energies, Named
from dalembert.elements.fem.nodal import ROTATIONS
from dalembert.elements.fem.stiffness_graphs import StiffnessGraphs
from dalembert.symbolic.once import once

STRESSLESS = 1e-9
"""Threshold of the first-order over the second-order energy below which it is round-off [-]."""


class ElementGraphs(StiffnessGraphs):
    """Energies of one element, and the functions derived from them by name.

    Parameters
    ----------
    cls : class of elements
    dimension : number of coordinates of a node
    node_count : nodes of one element
    options : switches of the kind
    linear : for small displacements: energies to second order, measures to first order
    """

    rotation_numbers: ClassVar[dict[int, int]] = {}
    """Dimension → entries of the rotation of a node, if they differ from the rotation axes."""

    def __init__(
        self,
        cls: type[Energies],
        dimension: int,
        node_count: int,
        options: dict[str, Any] | None = None,
        linear: bool = False,
    ):
        self.cls, self.dimension, self.node_count = cls, dimension, node_count
        self.linear = linear
        turns = len(ROTATIONS[dimension]) if cls.turns else 0
        displaced = dimension + (self.rotation_numbers.get(dimension, turns) if cls.turns else 0)
        self._u = [ca.SX.sym(f"u{k}", displaced) for k in range(node_count)]
        self._v = [ca.SX.sym(f"v{k}", dimension + turns) for k in range(node_count)]
        self._x = [ca.SX.sym(f"x{k}", dimension) for k in range(node_count)]
        numbers = {f.name: ca.SX.sym(f.name, f.metadata["size"]) for f in cls.quantity_fields()}
        self.at = ca.SX.sym("at", len(cls.samples[0]))
        self._q: dict[str, Any] = {**numbers, **(options or {}), "at": self.at}
        self.u, self.v = ca.vertcat(*self._u), ca.vertcat(*self._v)
        self.data = ca.vertcat(*self._x, *numbers.values())

    @property
    def contractible(self) -> bool:
        """Whether the energy depends on the displacement gradient only."""
        return self.cls.contractible

    # energies -----------------------------------------------------------------------------
    @cached_property
    def exact(self) -> ca.SX:
        """Strain energy at displacements of any size."""
        return ca.SX(self.cls.energy(self._u, self._x, self._q))

    @cached_property
    def energy(self) -> ca.SX:
        """Strain energy."""
        return self._quadratic(self.exact) if self.linear else self.exact

    @property
    def whole_energy(self) -> ca.SX:
        """Strain energy including thermal effects."""
        thermal = ca.SX(self.cls.thermal(self._u, self._x, self._q))
        return self.energy + (self._expanded(thermal, 1) if self.linear else thermal)

    @cached_property
    def measures(self) -> Named:
        """Measures of the class: name → (expression, unit)."""
        measures = self.cls.recovered(self._u, self._x, self._q)
        if self.linear:
            measures = {
                name: (self._expanded(sx, 1), unit) for name, (sx, unit) in measures.items()
            }
        return measures | self.cls.derived(
            {name: sx for name, (sx, _) in measures.items()}, self._q
        )

    def _expanded(self, value: ca.SX, order: int) -> ca.SX:
        """Taylor polynomial in the displacements about zero."""
        return sum(self._terms(value, order), ca.SX(0))

    def _terms(self, value: ca.SX, order: int) -> list[ca.SX]:
        """Terms of the Taylor polynomial in the displacements, from order zero."""
        scale = ca.SX.sym("scale")
        scaled = ca.substitute(value, self.u, scale * self.u)
        terms, factorial = [ca.substitute(scaled, scale, ca.SX(0))], 1
        for k in range(1, order + 1):
            scaled, factorial = ca.jacobian(scaled, scale), factorial * k
            terms.append(ca.substitute(scaled, scale, ca.SX(0)) / factorial)
        return terms

    def _quadratic(self, energy: ca.SX) -> ca.SX:
        """A strain energy to second order.

        Elements without initial stress have no energy of lower orders. Its round-off would be a
        force at rest that exceeds small loads.
        """
        terms = self._terms(energy, 2)
        inputs = [self.u, self.data, self.at]
        sizes = ca.Function("sizes", inputs, [ca.vertcat(*terms)])
        free = all(
            abs(first) <= STRESSLESS * abs(second)
            for _, first, second in (_random_values(sizes, seed) for seed in range(3))
        )
        return terms[2] if free else sum(terms, ca.SX(0))

    def slope(self, energy: ca.SX) -> ca.SX:
        """Internal forces of an energy."""
        return ca.gradient(energy, self.u)

    # functions ----------------------------------------------------------------------------
    @once
    def function(self, key: str) -> ca.Function:
        """The function of the sample and further columns that a method ``_key`` states."""
        action, _, name = key.partition(" ")
        inputs, outputs = getattr(self, f"_{action}")(*([name] if name else []))
        outputs = [ca.densify(ca.SX(o)) for o in outputs]
        return ca.Function(action, [self.at, *inputs], outputs, {"cse": True})

    @property
    def _forces(self) -> ca.SX:
        (w,) = self._symbols("w")
        return ca.gradient(self.energy, self.u) + ca.gradient(self._additional_work(w), w)

    def _work(self, w: ca.SX) -> ca.SX:
        """Virtual work of the internal forces on displacements ``w``."""
        return ca.jtimes(self.energy, self.u, w) + self._additional_work(w)

    def _additional_work(self, w: ca.SX) -> ca.SX:
        """Virtual work of forces not included in the energy."""
        parts = ca.vertsplit(w, self._u[0].numel())
        work = ca.SX(self.cls.virtual_work(self._u, parts, self._x, self._q))
        return self._expanded(work, 1) if self.linear else work

    def _force(self):
        return [self.u, self.data], [self._forces]

    def _tangent(self):
        return [self.u, self.data], [ca.vec(self._slopes(self._forces).T)]

    def _push(self):
        (change,) = self._symbols("change")
        return [self.u, self.data, change], [ca.jtimes(self._forces, self.data, change)]

    def _pull(self):
        (w,) = self._symbols("w")
        return [self.u, self.data, w], [ca.gradient(self._work(w), self.data)]

    def _turn(self):
        """Derivatives of ``Kᵀ w`` and of ``pull`` along displacements and data."""
        (w,) = self._symbols("w")
        return self._second_derivatives(self._work(w), w)

    def _second_derivatives(self, value: ca.SX, weights: ca.SX):
        """Derivative of the gradient of a weighted value along a direction."""
        du, change = self._symbols("du", "change")
        arguments = ca.vertcat(self.u, self.data)
        directional = ca.jtimes(ca.gradient(value, arguments), arguments, ca.vertcat(du, change))
        outputs = ca.vertsplit(directional, [0, self.u.numel(), arguments.numel()])
        return [self.u, self.data, weights, du, change], outputs

    def _push_tangent(self):
        change, du, b = self._symbols("change", "du", "b")
        product = ca.jtimes(self._forces, self.u, b)
        pushed = ca.jtimes(product, self.u, du) + ca.jtimes(product, self.data, change)
        return [self.u, self.data, change, du, b], [pushed]

    def _pull_tangent(self):
        a, b = self._symbols("a", "b")
        value = ca.jtimes(self._work(a), self.u, b)
        return [self.u, self.data, a, b], [ca.gradient(value, s) for s in (self.u, self.data)]

    # measures and checks
    def _value(self, name: str) -> ca.SX:
        totals = {"energy": self.whole_energy, "mass": self.mass}
        return totals[name] if name in totals else self.measures[name][0]

    def _measure(self, name: str):
        return [self.u, self.data], [self._value(name)]

    def _weigh(self, name: str):
        value = self._value(name)
        w = ca.SX.sym("w", value.numel())
        adjoints = [ca.jtimes(value, s, w, True) for s in (self.u, self.data)]
        return [self.u, self.data, w], adjoints

    def _turn_measure(self, name: str):
        value = self._value(name)
        w = ca.SX.sym("w", value.numel())
        return self._second_derivatives(ca.dot(w, value), w)

    @cached_property
    def checks(self) -> list[tuple[ca.SX, str]]:
        """(expression that must be positive, message if it is not)."""
        return self.cls.checks(self._x, self._q)

    def _checks(self):
        return [self.data], [ca.vertcat(*(value for value, _ in self.checks))]


def _random_values(function: ca.Function, seed: int) -> np.ndarray:
    """Values of a function at random arguments."""
    generator = np.random.default_rng(seed)
    inputs = [generator.uniform(0.1, 0.4, function.size_in(k)) for k in range(function.n_in())]
    return function(*inputs).full().ravel()


class ThermalGraphs(ElementGraphs):
    """Graphs of the thermal part of the energy of an element."""

    contractible = False

    def _additional_work(self, w: ca.SX) -> ca.SX:
        return ca.SX(0)

    @cached_property
    def exact(self) -> ca.SX:
        return ca.SX(self.cls.thermal(self._u, self._x, self._q))


@lru_cache
def graphs_of(
    cls: type[Energies],
    dimension: int,
    node_count: int,
    options: tuple[tuple[str, Any], ...],
    linear: bool,
    thermal: bool,
) -> ElementGraphs:
    """Graphs of a kind of element or of its thermal part, cached: structures share them."""
    graphs = ThermalGraphs if thermal else ElementGraphs
    return graphs(cls, dimension, node_count, dict(options), linear and not thermal)
