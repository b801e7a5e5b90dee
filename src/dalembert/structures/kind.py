"""One class of elements as compiled functions, evaluated for all its elements at once."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.structures.base import Rows, StructuralElement
from dalembert.structures.graphs import ElementGraphs
from dalembert.structures.lumping import Lumping
from dalembert.symbolic.kernel import Kernel

Columns = tuple[np.ndarray, ...]
CHUNK = 4096
"""Elements whose matrices are made at once."""


class ElementKind:
    """Energy, forces, stiffness, masses and their derivatives for one class of elements.

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
        options: dict[str, Any] | None = None,
        linear: bool = False,
    ):
        self.linear = linear
        self.cls, self.dimension, self.node_count = cls, dimension, node_count
        self.quantities = [field.name for field in cls.quantity_fields()]
        self.graphs = ElementGraphs(cls, dimension, node_count, options or {}, linear)
        self.displacement_count = self.graphs.u.numel()
        self.data_count = self.graphs.data.numel()
        self.per_node = self.displacement_count // node_count
        self._lumping = Lumping(dimension, node_count, self.per_node)
        self._functions: dict[str, ca.Function] = {}
        self._kernels: dict[tuple[str, int], Kernel] = {}

    # strain energy ------------------------------------------------------------------------
    def forces(self, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(k, ne) internal forces from displacements (k, ne) and data (m, ne)."""
        return self._energy("force", u, data)[0]

    def tangents(self, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(k, k, ne) tangent stiffnesses."""
        if self.cls.contractible:
            return self._contracted("moduli", u, data)
        return self._matrices("tangent", self.cls.samples, u, data)

    def push(self, u: np.ndarray, data: np.ndarray, change: np.ndarray) -> np.ndarray:
        """(k, ne) change of the forces with a change of the data."""
        return self._energy("push", u, data, change)[0]

    def pull(self, u: np.ndarray, data: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """(m, ne) weights of the data from weights (k, ne) of the forces."""
        return self._energy("pull", u, data, weights)[0]

    def turn(self, u, data, weights, du, change) -> tuple[np.ndarray, np.ndarray]:
        """Changes of ``K w`` (k, ne) and of ``pull`` (m, ne) with displacements and data."""
        found = self._energy("turn", u, data, weights, du, change)
        return found[0], found[1]

    def push_tangent(
        self, u: np.ndarray, data: np.ndarray, change: np.ndarray, du: np.ndarray, b: np.ndarray
    ) -> np.ndarray:
        """(k, ne) change of ``K(u, data) b`` with changes of the data and of ``u``."""
        return self._energy("push_tangent", u, data, change, du, b)[0]

    def pull_tangent(
        self, u: np.ndarray, data: np.ndarray, a: np.ndarray, b: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Weights of displacements (k, ne) and data (m, ne) in ``aᵀ K(u, data) b``."""
        found = self._energy("pull_tangent", u, data, a, b)
        return found[0], found[1]

    def geometric(self, u0: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(k, k, ne) derivative of the exact tangent at rest along displacements ``u0``."""
        if self.cls.contractible:
            return self._contracted("geometric_moduli", u0, data)
        return self._matrices("geometric", self.cls.samples, u0, data)

    def push_geometric(
        self, u0: np.ndarray, data: np.ndarray, change: np.ndarray, du: np.ndarray, b: np.ndarray
    ) -> np.ndarray:
        """(k, ne) change of ``K_g(u0, data) b`` with changes of the data and of ``u0``."""
        return self._energy("push_geometric", u0, data, change, du, b)[0]

    def pull_geometric(
        self, u0: np.ndarray, data: np.ndarray, a: np.ndarray, b: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Weights of ``u0`` (k, ne) and data (m, ne) in ``aᵀ K_g(u0, data) b``."""
        found = self._energy("pull_geometric", u0, data, a, b)
        return found[0], found[1]

    # masses -------------------------------------------------------------------------------
    def masses(self, data: np.ndarray, lumped: bool = False) -> np.ndarray:
        """(k, k, ne) mass matrices of the elements in their initial places."""
        if not lumped:
            return self._matrices("masses", self.cls.kinetic_samples, data)
        k = self.displacement_count
        found = np.zeros((k, k, data.shape[1]))
        found[np.arange(k), np.arange(k)] = self._lumped(data)
        return found

    def push_mass(
        self, b: np.ndarray, data: np.ndarray, change: np.ndarray, lumped: bool = False
    ) -> np.ndarray:
        """(k, ne) change of ``M b`` with a change of the data."""
        if not lumped:
            return self._kinetic("push_mass", b, data, change)[0]
        inertia, reference, scaled = self._inertia(data)
        moved = self._kinetic("push_diagonal", data, change)[0]
        of_scale = self._kinetic("push_diagonal", scaled, change)[0]
        scales = self._lumping.scales(reference)
        return b * (scales * moved[:-1] + inertia[:-1] * self._lumping.push(reference, of_scale))

    def pull_mass(
        self, a: np.ndarray, b: np.ndarray, data: np.ndarray, lumped: bool = False
    ) -> np.ndarray:
        """(m, ne) weights of the data in ``aᵀ M b``."""
        if not lumped:
            return self._kinetic("pull_mass", a, b, data)[0]
        inertia, reference, scaled = self._inertia(data)
        own = np.zeros_like(inertia)
        own[:-1] = a * b * self._lumping.scales(reference)
        of_scale = self._lumping.pull(reference, a * b * inertia[:-1])
        return (
            self._kinetic("pull_diagonal", data, own)[0]
            + self._kinetic("pull_diagonal", scaled, of_scale)[0]
        )

    def _lumped(self, data: np.ndarray) -> np.ndarray:
        inertia, reference, _ = self._inertia(data)
        return inertia[:-1] * self._lumping.scales(reference)

    def _inertia(self, data: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Diagonal and mass; the same, and the data, with a density where there is none.

        Scales do not depend on the density, and are 0/0 without.
        """
        scaled = data
        if "density" in self.quantities:
            row, scaled = self._row("density"), data.copy()
            scaled[row, data[row] == 0] = 1.0
        found = [self._kinetic("diagonal", d)[0] for d in (data, scaled)]
        return found[0], found[1], scaled

    def _row(self, quantity: str) -> int:
        """Row of a quantity in the data."""
        sizes = {f.name: f.metadata["size"] for f in self.cls.quantity_fields()}
        after = list(sizes)[list(sizes).index(quantity) :]
        return self.data_count - sum(sizes[name] for name in after)

    # measures -----------------------------------------------------------------------------
    @cached_property
    def measures(self) -> dict[str, tuple[Any, str]]:
        """Name → (expression, unit), the energy among them."""
        graphs = self.graphs
        return {**graphs.measures, "energy": (graphs.energy, "J"), "mass": (graphs.mass, "kg")}

    def unit(self, name: str) -> str | None:
        """Unit of a measure, one at a station such as a node too; None if there is none."""
        base = self._station(name)[0]
        return self.measures[base][1] if base in self.measures else None

    def measure(self, name: str, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(s, ne) values of a measure."""
        base, samples = self._station(name)
        return self._sum(f"measure {base}", samples, u, data)[0]

    def pull_measure(
        self, name: str, u: np.ndarray, data: np.ndarray, weights: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Weights of displacements (k, ne) and data (m, ne) from those of a measure."""
        base, samples = self._station(name)
        found = self._sum(f"weigh {base}", samples, u, data, weights)
        return found[0], found[1]

    def turn_measure(self, name: str, u, data, weights, du, change) -> tuple[np.ndarray, ...]:
        """Changes of what ``pull_measure`` gives with displacements and data."""
        base, samples = self._station(name)
        return tuple(self._sum(f"turn_measure {base}", samples, u, data, weights, du, change))

    def _station(self, name: str) -> tuple[str, Rows]:
        """What is measured, and the samples it is summed over."""
        if name == "energy":
            return name, self.cls.samples
        if name == "mass":
            return name, self.cls.kinetic_samples
        if name not in self.measures:
            base, _, station = name.rpartition("_")
            if station and station in self.cls.stations:
                return base, (self.cls.stations[station],)
        return name, (self.cls.stations[""],)

    def faults(self, data: np.ndarray) -> Iterator[tuple[int, str]]:
        """Elements whose shape or material is impossible: row, and what is wrong with it."""
        checks = self.graphs.checks
        if not checks:
            return
        least = np.full((len(checks), data.shape[1]), np.inf)
        for at in self.cls.samples:
            least = np.minimum(least, self._at("checks", (at,), data)[0])
        for row, element in np.argwhere(~(least > 0)):  # NaN is wrong too
            yield int(element), checks[row][1].format(least[row, element])

    # evaluated for many -------------------------------------------------------------------
    def _energy(self, what: str, *columns: np.ndarray) -> list[np.ndarray]:
        return self._sum(what, self.cls.samples, *columns)

    def _kinetic(self, what: str, *columns: np.ndarray) -> list[np.ndarray]:
        return self._sum(what, self.cls.kinetic_samples, *columns)

    def _sum(self, what: str, samples: Rows, *columns: np.ndarray) -> list[np.ndarray]:
        """Results (rows, ne), added up over the samples, as many at once as make one chunk."""
        step = max(1, CHUNK // max(columns[0].shape[1], 1))
        total = self._several(what, samples[:step], columns)
        for begin in range(step, len(samples), step):
            parts = self._several(what, samples[begin : begin + step], columns)
            total = [sum_ + part for sum_, part in zip(total, parts, strict=True)]
        return total

    def _several(self, what: str, samples: Rows, columns: Columns) -> list[np.ndarray]:
        """Results (rows, ne) added up over a few samples."""
        if len(samples) == 1:
            return self._at(what, samples, *columns)
        tiled = (np.tile(column, len(samples)) for column in columns)
        found = self._at(what, samples, *tiled)
        return [f.reshape(len(f), len(samples), -1).sum(axis=1) for f in found]

    def _at(self, what: str, samples: Rows, *columns: np.ndarray) -> list[np.ndarray]:
        """Results for columns that go through all elements for each sample in turn."""
        count = columns[0].shape[1]
        if (what, count) not in self._kernels:
            if what not in self._functions:
                self._functions[what] = self.graphs.function(what)
            self._kernels[what, count] = Kernel(self._functions[what].map(count))
        rows = np.array(samples, dtype=float).reshape(len(samples), -1)
        at = np.repeat(rows, count // len(samples), axis=0).T
        return self._kernels[what, count](at, *columns)

    def _matrices(self, what: str, samples: Rows, *columns: np.ndarray) -> np.ndarray:
        k, count = self.displacement_count, columns[0].shape[1]
        return self._sum(what, samples, *columns)[0].reshape(k, k, count)

    def _contracted(self, what: str, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        """``Σ ∇N_a · 𝗔 · ∇N_b``, the matrices of an energy of the displacement gradient."""
        k, n, d, count = self.displacement_count, self.node_count, self.dimension, u.shape[1]
        total = np.zeros((count, k, k))
        for begin in range(0, count, CHUNK):
            part = slice(begin, min(begin + CHUNK, count))
            for at in self.cls.samples:
                slopes, moduli = (
                    r.ravel(order="F") for r in self._at(what, (at,), u[:, part], data[:, part])
                )
                size = slopes.size // (n * d)
                by = slopes.reshape(size, d, n).transpose(0, 2, 1)
                half = by @ moduli.reshape(size, d, d**3)
                half = half.reshape(size, n, d, d, d).transpose(0, 3, 4, 1, 2)
                total[part] += (by @ half.reshape(size, d, -1)).reshape(size, k, k)
        return np.moveaxis(total, 0, 2)
