"""One class of elements as compiled functions, evaluated for all its elements at once."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.structures.base import StructuralElement
from dalembert.structures.node import ROTATIONS
from dalembert.symbolic.kernel import Kernel


class ElementKind:
    """Energy, forces, stiffness and their derivatives for one class of elements.

    ``data`` of an element are the coordinates of its nodes, then its quantities.

    Parameters
    ----------
    cls : class of elements
    dimension : of space
    node_count : nodes of one element
    options : switches that the elements have in common
    linear : for small displacements: energies up to the second, measures to the first order
    """

    def __init__(
        self,
        cls: type[StructuralElement],
        dimension: int,
        node_count: int,
        options: dict[str, bool] | None = None,
        linear: bool = False,
    ):
        self.linear = linear
        self.cls, self.dimension, self.node_count = cls, dimension, node_count
        self.per_node = dimension + (len(ROTATIONS[dimension]) if cls.turns else 0)
        self.quantities = [field.name for field in cls.quantity_fields()]
        self.u = [ca.SX.sym(f"u{k}", self.per_node) for k in range(node_count)]
        self.x = [ca.SX.sym(f"x{k}", dimension) for k in range(node_count)]
        numbers = {name: ca.SX.sym(name) for name in self.quantities}
        self.q: dict[str, Any] = {**numbers, **(options or {})}
        self._displacement = ca.vertcat(*self.u)
        self._data = ca.vertcat(*self.x, *numbers.values())
        self._maps: dict[tuple[str, int], Kernel] = {}

    @property
    def displacement_count(self) -> int:
        """Displacements of one element."""
        return self._displacement.numel()

    @property
    def data_count(self) -> int:
        """Numbers that describe one element."""
        return self._data.numel()

    @cached_property
    def energy(self) -> ca.SX:
        """Strain energy."""
        exact = self.cls.energy(self.u, self.x, self.q)
        if not self.linear:
            return exact
        u = self._displacement
        hessian, gradient = ca.hessian(exact, u)
        at_zero = ca.substitute([exact, gradient, hessian], [u], [ca.SX.zeros(u.numel())])
        return at_zero[0] + ca.dot(at_zero[1], u) + ca.dot(u, ca.mtimes(at_zero[2], u)) / 2

    def _small(self, measure: ca.SX) -> ca.SX:
        """A measure up to the first order of the displacements."""
        u = self._displacement
        slope, base = ca.substitute(
            [ca.jacobian(measure, u), measure], [u], [ca.SX.zeros(u.numel())]
        )
        return base + ca.mtimes(slope, u)

    @cached_property
    def force(self) -> ca.SX:
        """``∂W/∂u``, the force that holds the displaced element."""
        return ca.gradient(self.energy, self._displacement)

    @cached_property
    def mass(self) -> ca.SX:
        return ca.SX(self.cls.mass(self.x, self.q))

    @cached_property
    def measures(self) -> dict[str, tuple[ca.SX, str]]:
        """Name → (expression, unit), the energy among them."""
        named = self.cls.measures(self.u, self.x, self.q)
        if self.linear:
            named = {name: (self._small(sx), unit) for name, (sx, unit) in named.items()}
        return {**named, "energy": (self.energy, "J"), "mass": (self.mass, "kg")}

    # evaluated for many -------------------------------------------------------------------
    def forces(self, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(k, ne) internal forces from displacements (k, ne) and data (m, ne)."""
        return self._over("force", u, data)[0]

    def tangents(self, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(k, k, ne) tangent stiffnesses."""
        flat = self._over("tangent", u, data)[0]
        k, count = self.displacement_count, u.shape[1]
        return flat.reshape(k * k, count).reshape(k, k, count)

    def push(self, u: np.ndarray, data: np.ndarray, change: np.ndarray) -> np.ndarray:
        """(k, ne) change of the forces with a change of the data."""
        return self._over("push", u, data, change)[0]

    def pull(self, u: np.ndarray, data: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """(m, ne) weights of the data from weights (k, ne) of the forces."""
        return self._over("pull", u, data, weights)[0]

    def measure(self, name: str, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(s, ne) values of a measure."""
        return self._over(f"measure {name}", u, data)[0]

    def pull_measure(
        self, name: str, u: np.ndarray, data: np.ndarray, weights: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Weights of displacements (k, ne) and data (m, ne) from those of a measure."""
        found = self._over(f"pull {name}", u, data, weights)
        return found[0], found[1]

    def _over(self, what: str, *arguments: np.ndarray) -> list[np.ndarray]:
        key = (what, arguments[0].shape[1])
        if key not in self._maps:
            self._maps[key] = Kernel(self._function(what).map(key[1]))
        return self._maps[key](*arguments)

    def _function(self, what: str) -> ca.Function:
        u, data = self._displacement, self._data
        weights, change = ca.SX.sym("w", u.numel()), ca.SX.sym("change", data.numel())
        if what == "force":
            return self._compiled(what, [u, data], [self.force])
        if what == "tangent":
            return self._compiled(what, [u, data], [ca.vec(ca.jacobian(self.force, u))])
        if what == "push":
            return self._compiled(what, [u, data, change], [ca.jtimes(self.force, data, change)])
        if what == "pull":
            pulled = ca.jtimes(self.force, data, weights, True)
            return self._compiled(what, [u, data, weights], [pulled])
        action, _, name = what.partition(" ")
        value = self.measures[name][0]
        if action == "measure":
            return self._compiled("measure", [u, data], [value])
        weight = ca.SX.sym("w", value.numel())
        back = [ca.jtimes(value, s, weight, True) for s in (u, data)]
        return self._compiled("pull", [u, data, weight], back)

    @staticmethod
    def _compiled(name: str, inputs: list[ca.SX], outputs: list[ca.SX]) -> ca.Function:
        return ca.Function(name, inputs, [ca.densify(o) for o in outputs], {"cse": True})
