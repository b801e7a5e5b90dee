"""Masses and inertia forces of the elements of one kind, consistent or lumped."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from dalembert.structures.evaluation.compiled import Evaluation
from dalembert.structures.evaluation.lumping import Lumping

Moved = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Displacements, velocities and accelerations."""


def from_rest(a: np.ndarray, u: np.ndarray | float = 0.0) -> Moved:
    """A motion from rest with these accelerations; its inertia forces are ``M(u) a``."""
    return u + np.zeros_like(a), np.zeros_like(a), a


def _name(lumped: bool) -> str:
    return "lumped" if lumped else "consistent"


class KindInertia(Evaluation):
    """Mass matrices and inertia forces from the kinetic energy of the elements."""

    @cached_property
    def _lumping(self) -> Lumping:
        return Lumping(self.dimension, self.node_count, self.per_node)

    def masses(self, data: np.ndarray, lumped: bool = False) -> np.ndarray:
        """(k, k, ne) mass matrices of the elements in the initial configuration."""
        if not lumped:
            return self._matrices("masses", self.cls.kinetic_samples, data)
        k = self.displacement_count
        masses = np.zeros((k, k, data.shape[1]))
        masses[np.arange(k), np.arange(k)] = self._lumped(data)
        return masses

    # displaced elements -------------------------------------------------------------------
    def turning(self, lumped: bool) -> bool:
        """Whether the inertia depends on the displacements."""
        return self.graphs.turning(_name(lumped))

    def inertia_forces(self, motion: Moved, data: np.ndarray, lumped: bool) -> np.ndarray:
        """(k, ne) ``d/dt ∂T/∂v − ∂T/∂u`` of displacements, velocities and accelerations (k, ne)."""
        return self._moved("inertia_forces", lumped, *motion, self._numbers(data, lumped))[0]

    def inertia_slopes(self, motion: Moved, data: np.ndarray, lumped: bool) -> list[np.ndarray]:
        """(k, k, ne) derivatives of the inertia forces by each of the three."""
        k = self.displacement_count
        slopes = self._moved("inertia_slopes", lumped, *motion, self._numbers(data, lumped))
        return [part.reshape(k, k, -1).transpose(1, 0, 2) for part in slopes]

    def push_inertia(
        self, motion: Moved, data: np.ndarray, change: np.ndarray, lumped: bool
    ) -> np.ndarray:
        """(k, ne) change of the inertia forces with a change of the data."""
        change_of_numbers = self._push_lumped(data, change) if lumped else change
        arguments = *motion, self._numbers(data, lumped), change_of_numbers
        return self._moved("push_inertia", lumped, *arguments)[0]

    def pull_inertia(
        self, motion: Moved, data: np.ndarray, weights: np.ndarray, lumped: bool
    ) -> np.ndarray:
        """(m, ne) weights of the data from weights (k, ne) of the inertia forces."""
        arguments = *motion, self._numbers(data, lumped), weights
        numbers_bar = self._moved("pull_inertia", lumped, *arguments)[0]
        return self._pull_lumped(data, numbers_bar) if lumped else numbers_bar

    def turn_inertia(
        self, motion: Moved, data: np.ndarray, weights: np.ndarray, change: np.ndarray
    ) -> np.ndarray:
        """(m, ne) change of the result of ``pull_inertia`` with the data, consistent masses."""
        return self._moved("turn_inertia", False, *motion, data, weights, change)[0]

    def kinetic_energy(
        self, u: np.ndarray, v: np.ndarray, data: np.ndarray, lumped: bool
    ) -> tuple[np.ndarray, ...]:
        """(ne,) energies; their slopes by displacements, velocities (k, ne) and data (m, ne)."""
        numbers = self._numbers(data, lumped)
        energy, by_u, by_v, by_numbers = self._moved("kinetic_energy", lumped, u, v, numbers)
        return (
            energy.ravel(),
            by_u,
            by_v,
            self._pull_lumped(data, by_numbers) if lumped else by_numbers,
        )

    def _moved(self, name: str, lumped: bool, *columns: np.ndarray) -> list[np.ndarray]:
        samples = self.cls.kinetic_samples
        return self._sum(f"{name} {_name(lumped)}", samples[:1] if lumped else samples, *columns)

    def _numbers(self, data: np.ndarray, lumped: bool) -> np.ndarray:
        """Data of the kinetic energy: lumped diagonals, or the element data."""
        return self._lumped(data) if lumped else data

    # lumped masses ------------------------------------------------------------------------
    def _lumped(self, data: np.ndarray) -> np.ndarray:
        """(k, ne) diagonals."""
        inertia, reference, _ = self._inertia(data)
        return inertia[:-1] * self._lumping.scales(reference)

    def _push_lumped(self, data: np.ndarray, change: np.ndarray) -> np.ndarray:
        inertia, reference, scaled = self._inertia(data)
        moved = self._kinetic("push_diagonal", data, change)[0]
        of_scale = self._kinetic("push_diagonal", scaled, change)[0]
        scales = self._lumping.scales(reference)
        return scales * moved[:-1] + inertia[:-1] * self._lumping.push(reference, of_scale)

    def _pull_lumped(self, data: np.ndarray, weights: np.ndarray) -> np.ndarray:
        inertia, reference, scaled = self._inertia(data)
        own = np.zeros_like(inertia)
        own[:-1] = weights * self._lumping.scales(reference)
        of_scale = self._lumping.pull(reference, weights * inertia[:-1])
        return (
            self._kinetic("pull_diagonal", data, own)[0]
            + self._kinetic("pull_diagonal", scaled, of_scale)[0]
        )

    def _inertia(self, data: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Diagonal and mass; the same with unit density where it is zero, and the data for it.

        Scales do not depend on the density, but are 0/0 at zero density.
        """
        scaled = data
        if "density" in self.quantities:
            row, scaled = self.row("density"), data.copy()
            scaled[row, data[row] == 0] = 1.0
        inertia = [self._kinetic("diagonal", d)[0] for d in (data, scaled)]
        return inertia[0], inertia[1], scaled

    def row(self, quantity: str) -> int:
        """Row of a quantity in the data."""
        sizes = {f.name: f.metadata["size"] for f in self.cls.quantity_fields()}
        after = list(sizes)[list(sizes).index(quantity) :]
        return self.data_count - sum(sizes[name] for name in after)
