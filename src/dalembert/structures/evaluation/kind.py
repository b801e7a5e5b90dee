"""One class of elements as compiled functions, evaluated for all its elements at once."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any

import numpy as np

from dalembert.elements.fem.energies import Rows
from dalembert.structures.evaluation.inertia import KindInertia


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
        """(k, k, ne) derivative of the exact tangent at rest along displacements ``u0``."""
        return self._stiffness("geometric", "geometric_moduli", u0, data)

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

    def push_stiffness(self, u, data, change, du, b, geometric: bool = False) -> np.ndarray:
        """(k, ne) change of ``K(u, data) b``, or of ``K_g(u, data) b``."""
        name = "push_geometric" if geometric else "push_tangent"
        return self._energy(name, u, data, change, du, b)[0]

    def pull_stiffness(self, u, data, a, b, geometric: bool = False) -> tuple[np.ndarray, ...]:
        """Weights of displacements (k, ne) and data (m, ne) in ``aᵀ K b``, or ``aᵀ K_g b``."""
        return tuple(self._energy("pull_geometric" if geometric else "pull_tangent", u, data, a, b))

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
        base = self._station(name)[0]
        return self.measures[base][1] if base in self.measures else None

    def measure(self, name: str, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        """(s, ne) values of a measure."""
        base, samples = self._station(name)
        return self._sum(f"measure {base}", samples, u, data)[0]

    def pull_measure(
        self, name: str, u: np.ndarray, data: np.ndarray, weights: np.ndarray
    ) -> tuple[np.ndarray, ...]:
        """Weights of displacements (k, ne) and data (m, ne) from those of a measure."""
        base, samples = self._station(name)
        return tuple(self._sum(f"weigh {base}", samples, u, data, weights))

    def turn_measure(self, name: str, u, data, weights, du, change) -> tuple[np.ndarray, ...]:
        """Changes of the result of ``pull_measure`` with displacements and data."""
        base, samples = self._station(name)
        return tuple(self._sum(f"turn_measure {base}", samples, u, data, weights, du, change))

    def _station(self, name: str) -> tuple[str, Rows]:
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
