"""Elements of one kind: their compiled functions, and a block with connectivity and data."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any, Literal

import casadi as ca
import numpy as np

from dalembert.elements.fem.energies import Rows
from dalembert.model.assembled.evaluation.inertia import KindInertia, Moved
from dalembert.model.spans import Spans
from dalembert.model.value_limits import ValueLimit
from dalembert.symbolic.parametric_array import ParametricArray

Stiffness = Literal["tangent", "geometric", "change"]
"""The tangent, the stiffness by stresses, and the change of the exact tangent at rest."""


class ElementKind(KindInertia):
    """Energy, forces, stiffness, masses and their derivatives for one class of elements.

    ``data`` of an element are the coordinates of its nodes, then its quantities.

    Parameters
    ----------
    graphs : graphs of the class, or of its thermal terms
    """

    # strain energy ------------------------------------------------------------------------
    def forces(self, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(k, ne) internal forces from displacements (k, ne) and data (m, ne)."""
        return self._energy("force", u, data)[0]

    def tangents(self, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(k, k, ne) tangent stiffnesses."""
        return self._stiffness("tangent", "moduli", u, data)

    def geometric(self, u0: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(k, k, ne) stiffnesses at rest by the stresses of displacements ``u0``."""
        return self._stiffness("geometric", "geometric_moduli", u0, data)

    def stiffness_change(self, u0: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(k, k, ne) derivative of the exact tangent at rest along displacements ``u0``."""
        return self._stiffness("change", "change_moduli", u0, data)

    def _stiffness(self, name: str, moduli: str, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        if self.graphs.contractible:
            return self._contracted(moduli, u, data)
        return self._matrices(name, self.cls.samples, u, data)

    def push(self, u: np.ndarray, data: np.ndarray, change: np.ndarray) -> np.ndarray:
        """(k, ne) change of the forces with a change of the data."""
        return self._energy("push", u, data, change)[0]

    def pull(self, u: np.ndarray, data: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """(m, ne) weights of the data from weights (k, ne) of the forces."""
        return self._energy("pull", u, data, weights)[0]

    def turn(self, u, data, weights, du, change) -> tuple[np.ndarray, ...]:
        """Changes of ``Kᵀ w`` (k, ne) and of ``pull`` (m, ne) with displacements and data."""
        return tuple(self._energy("turn", u, data, weights, du, change))

    def push_stiffness(self, u, data, change, du, b, of: Stiffness = "tangent") -> np.ndarray:
        """(k, ne) change of ``K(u, data) b`` of a kind of stiffness."""
        return self._energy(f"push_{of}", u, data, change, du, b)[0]

    def pull_stiffness(self, u, data, a, b, of: Stiffness = "tangent") -> tuple[np.ndarray, ...]:
        """Weights of displacements (k, ne) and data (m, ne) in ``aᵀ K b``."""
        return tuple(self._energy(f"pull_{of}", u, data, a, b))

    # measures -----------------------------------------------------------------------------
    @cached_property
    def measures(self) -> dict[str, tuple[Any, str]]:
        """Name → (expression, unit), with energy and mass."""
        graphs = self.graphs
        return {
            **graphs.measures,
            "energy": (graphs.whole_energy, "J"),
            "mass": (graphs.mass, "kg"),
        }

    def unit(self, name: str) -> str | None:
        """Unit of a measure, also at a station such as a node; None for an unknown name."""
        base = self.station(name)[0]
        return self.measures[base][1] if base in self.measures else None

    def measure(self, name: str, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(s, ne) values of a measure."""
        base, samples = self.station(name)
        return self._sum(f"measure {base}", samples, u, data)[0]

    def pull_measure(
        self, name: str, u: np.ndarray, data: np.ndarray, weights: np.ndarray
    ) -> tuple[np.ndarray, ...]:
        """Weights of displacements (k, ne) and data (m, ne) from those of a measure."""
        base, samples = self.station(name)
        return tuple(self._sum(f"weigh {base}", samples, u, data, weights))

    def turn_measure(self, name: str, u, data, weights, du, change) -> tuple[np.ndarray, ...]:
        """Changes of the result of ``pull_measure`` with displacements and data."""
        base, samples = self.station(name)
        return tuple(self._sum(f"turn_measure {base}", samples, u, data, weights, du, change))

    def station(self, name: str) -> tuple[str, Rows]:
        """Base name of a measure, and the samples it is summed over."""
        if name == "energy":
            return name, self.cls.samples
        if name == "mass":
            return name, self.cls.kinetic_samples
        if name not in self.measures:
            base, _, station = name.rpartition("_")
            if station and station in self.cls.stations:
                return base, (self.cls.stations[station],)
        return name, (self.cls.stations[""],)

    def conditions(self, name: str, data: ca.SX) -> list[ValueLimit]:
        """Conditions of shape and material of one element, see ``faults``."""
        if not self.graphs.checks:
            return []
        check = self.graphs.function("checks")
        minimum = ca.SX.inf(len(self.graphs.checks))
        for at in self.cls.samples:
            minimum = ca.fmin(minimum, check(ca.DM(np.reshape(at, (len(at), 1))), data))
        return [
            ValueLimit(name, ca.vertcat(2 * (value > 0) - 1, value), message=message, count=1)
            for value, (_, message) in zip(ca.vertsplit(minimum), self.graphs.checks, strict=True)
        ]

    def faults(self, data: np.ndarray) -> Iterator[tuple[int, str]]:
        """Elements with invalid shape or material: row, and message."""
        checks = self.graphs.checks
        if not checks:
            return
        minimum = np.full((len(checks), data.shape[1]), np.inf)
        for at in self.cls.samples:
            minimum = np.minimum(minimum, self._at("checks", (at,), data)[0])
        for row, element in np.argwhere(~(minimum > 0)):  # NaN is wrong too
            yield int(element), checks[row][1].format(minimum[row, element])


class ElementBlock:
    """Elements of one kind.

    Parameters
    ----------
    kind : ElementKind
    names : names of the elements by row
    nodes : (nodes of an element, ne) numbers of the nodes
    degrees : (k, ne) numbers of the displacements in the structure
    data : ParametricArray of (m · ne) numbers, element by element
    """

    def __init__(
        self,
        kind: ElementKind,
        names: Spans,
        nodes: np.ndarray,
        degrees: np.ndarray,
        data: ParametricArray,
    ):
        self.kind, self.names, self.nodes = kind, names, nodes
        self.degrees, self._data = degrees, data
        self._cache: tuple[tuple[bytes, float], np.ndarray] | None = None
        self.count = degrees.shape[1]

    @property
    def depends_on_time(self) -> bool:
        """Whether the data depend on time."""
        return self._data.depends_on_time

    def data(self, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(m, ne) data at parameter values ``p``, read-only; the last result is cached."""
        key = p.tobytes(), time if self.depends_on_time else 0.0
        if self._cache is None or self._cache[0] != key:
            self._cache = key, self._shaped(self._data.values(p, time))
            self._cache[1].flags.writeable = False
        return self._cache[1]

    @property
    def data_formulas(self) -> np.ndarray:
        """(m, ne) data at time zero, numbers and formulas of parameters."""
        return self._shaped(self._data.formulas)

    def data_graph(self, p: ca.MX) -> ca.MX:
        """(m, ne) data at time zero as a graph of parameters."""
        return ca.reshape(self._data.graph(p), self.kind.data_count, self.count)

    def value_limits(self) -> list[ValueLimit]:
        """Limits and conditions of elements whose data depend on parameters."""
        if not self._data.index.size:
            return []
        data, limits = self.data_formulas, []
        row = data.shape[0] - sum(f.metadata["size"] for f in self.kind.cls.quantity_fields())
        for field in self.kind.cls.quantity_fields():
            meta = field.metadata
            for e, numbers in enumerate(data[row : row + meta["size"]].T):
                graph = ca.SX(ca.vertcat(*numbers))
                if ca.symvar(graph):
                    bounds = float(meta["minimum"]), float(meta["above"])
                    entity = f"{self.names.name(e)}.{field.name}"
                    limits.append(ValueLimit(entity, graph, meta["unit"], *bounds))
            row += meta["size"]
        for e, column in enumerate(data.T):
            numbers = ca.SX(ca.vertcat(*column))
            if ca.symvar(numbers):
                limits += self.kind.conditions(self.names.name(e), numbers)
        return limits

    def lengths(self, p: np.ndarray) -> np.ndarray:
        """(ne,) largest distances of the nodes from the first one [m]."""
        d, n = self.kind.dimension, self.kind.node_count
        positions = self.data(p)[: n * d].reshape(n, d, self.count)
        return np.linalg.norm(positions - positions[0], axis=1).max(axis=0)

    def push_data(self, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(m, ne) change of the data."""
        return self._shaped(self._data.push(p, dp, time))

    def pull_data(self, p: np.ndarray, weights: np.ndarray, time: float = 0.0) -> np.ndarray:
        """Weights of the parameters from weights (m, ne) of the data."""
        return self._data.pull(p, weights.ravel(order="F"), time)

    def turn_data(self, p: np.ndarray, weights: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """Change of the result of ``pull_data`` with the parameters."""
        return self._data.turn(p, weights.ravel(order="F"), dp)

    def turn(
        self, u: np.ndarray, p: np.ndarray, weights: np.ndarray, du: np.ndarray, dp: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Changes of ``Kᵀ w`` (k, ne), and of the weights of the parameters in ``wᵀ`` forces."""
        data, change = self.data(p), self.push_data(p, dp)
        own, turned = self.kind.turn(u, data, weights, du, change)
        bar = self.kind.pull(u, data, weights)
        return own, self.pull_data(p, turned) + self.turn_data(p, bar, dp)

    def turn_inertia(
        self, motion: Moved, p: np.ndarray, weights: np.ndarray, dp: np.ndarray
    ) -> np.ndarray:
        """Change of the weights of the parameters in ``wᵀ`` inertia forces."""
        data, change = self.data(p), self.push_data(p, dp)
        turned = self.kind.turn_inertia(motion, data, weights, change)
        bar = self.kind.pull_inertia(motion, data, weights, lumped=False)
        return self.pull_data(p, turned) + self.turn_data(p, bar, dp)

    def gather(self, u: np.ndarray) -> np.ndarray:
        """(k, ne) displacements of the elements."""
        return u[self.degrees]

    def gather_motion(self, motion: Moved) -> Moved:
        """(k, ne) displacements, velocities and accelerations of the elements."""
        u, v, a = motion
        return self.gather(u), self.gather(v), self.gather(a)

    def scatter(self, forces: np.ndarray, size: int) -> np.ndarray:
        """(n,) sum of element forces (k, ne) by displacement."""
        return np.bincount(self.degrees.ravel(), forces.ravel(), minlength=size)

    def _shaped(self, flat: np.ndarray) -> np.ndarray:
        return flat.reshape(self.kind.data_count, self.count, order="F")
