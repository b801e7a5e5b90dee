"""Compiled functions of one class of elements, with masses and inertia forces.

Lumped masses are the diagonal of the consistent mass matrix, scaled to the mass of the element:
Hinton, Rock and Zienkiewicz (Earthquake Engineering and Structural Dynamics 4, 1976). In every
direction the diagonal entries are scaled so that they add up to the mass; rotations take the mean
of the directions. For linear simplices and parallelograms these are the row sums.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from dalembert.elements.fem.energies import Rows
from dalembert.elements.fem.graphs import ElementGraphs
from dalembert.symbolic.evaluation import columns as symbolic
from dalembert.symbolic.evaluation.backends import Automatic

Columns = tuple[np.ndarray, ...]
CHUNK = 4096
"""Block size of the evaluation, in elements."""


class Evaluation:
    """Compiled functions of the element graphs by name; columns are elements.

    Parameters
    ----------
    graphs : graphs of the element class
    """

    def __init__(self, graphs: ElementGraphs):
        self.graphs, self.cls, self.linear = graphs, graphs.cls, graphs.linear
        self.dimension, self.node_count = graphs.dimension, graphs.node_count
        self.displacement_count, self.data_count = graphs.u.numel(), graphs.data.numel()
        self.per_node = self.displacement_count // self.node_count
        self.quantities = [field.name for field in graphs.cls.quantity_fields()]
        self._backend = Automatic()
        self._functions: dict[str, symbolic.Columns] = {}
        self._rows: dict[tuple[Rows, int], np.ndarray] = {}

    def _energy(self, name: str, *columns: np.ndarray) -> list[np.ndarray]:
        return self._sum(name, self.cls.samples, *columns)

    def _kinetic(self, name: str, *columns: np.ndarray) -> list[np.ndarray]:
        return self._sum(name, self.cls.kinetic_samples, *columns)

    def _sum(self, name: str, samples: Rows, *columns: np.ndarray) -> list[np.ndarray]:
        """Results (rows, ne), summed over the samples in blocks of the block size."""
        step = max(1, CHUNK // max(columns[0].shape[1], 1))
        total = self._several(name, samples[:step], columns)
        for begin in range(step, len(samples), step):
            parts = self._several(name, samples[begin : begin + step], columns)
            total = [sum_ + part for sum_, part in zip(total, parts, strict=True)]
        return total

    def _several(self, name: str, samples: Rows, columns: Columns) -> list[np.ndarray]:
        """Results (rows, ne) summed over a few samples."""
        if len(samples) == 1:
            return self._at(name, samples, *columns)
        tiled = (np.tile(column, len(samples)) for column in columns)
        results = self._at(name, samples, *tiled)
        return [f.reshape(len(f), len(samples), -1).sum(axis=1) for f in results]

    def _at(self, name: str, samples: Rows, *columns: np.ndarray) -> list[np.ndarray]:
        """Results for columns that run over all elements for each sample in turn."""
        count = columns[0].shape[1]
        if name not in self._functions:
            self._functions[name] = self._backend.columns(self.graphs.function(name))
        if (samples, count) not in self._rows:
            rows = np.array(samples, dtype=float).reshape(len(samples), -1)
            self._rows[samples, count] = np.repeat(rows, count // len(samples), axis=0).ravel()
        return self._functions[name](count, self._rows[samples, count], *columns)

    def _matrices(self, name: str, samples: Rows, *columns: np.ndarray) -> np.ndarray:
        k, count = self.displacement_count, columns[0].shape[1]
        return self._sum(name, samples, *columns)[0].reshape(k, k, count)

    def _contracted(self, name: str, u: np.ndarray, data: np.ndarray) -> np.ndarray:
        """``Σ ∇N_a · 𝗔 · ∇N_b``, the matrices of an energy of the displacement gradient."""
        k, n, d, count = self.displacement_count, self.node_count, self.dimension, u.shape[1]
        total = np.zeros((count, k, k))
        for begin in range(0, count, CHUNK):
            part = slice(begin, min(begin + CHUNK, count))
            for at in self.cls.samples:
                slopes, moduli = (
                    r.ravel(order="F") for r in self._at(name, (at,), u[:, part], data[:, part])
                )
                size = slopes.size // (n * d)
                by = slopes.reshape(size, d, n).transpose(0, 2, 1)
                half = by @ moduli.reshape(size, d, d**3)
                half = half.reshape(size, n, d, d, d).transpose(0, 3, 4, 1, 2)
                total[part] += (by @ half.reshape(size, d, -1)).reshape(size, k, k)
        return np.moveaxis(total, 0, 2)


class Lumping:
    """Scales of the diagonal, ``m / s`` with the sum ``s`` of the entries of a direction.

    Parameters
    ----------
    dimension : of space
    node_count, per_node : nodes, and displacements of each
    """

    def __init__(self, dimension: int, node_count: int, per_node: int):
        direction = np.minimum(np.arange(per_node), dimension)
        self._group = np.tile(direction, node_count)
        self._sum = (self._group == np.arange(dimension + 1)[:, None]).astype(float)
        self._sum[dimension] = self._sum[:dimension].mean(axis=0)

    def scales(self, inertia: np.ndarray) -> np.ndarray:
        """(k, ne) scales; one where there is no mass.

        Parameters
        ----------
        inertia : (k + 1, ne) diagonal entries, then the mass
        """
        return self._ratio(inertia)[0][self._group]

    def push(self, inertia: np.ndarray, change: np.ndarray) -> np.ndarray:
        """(k, ne) change of the scales with a change (k + 1, ne) of ``inertia``."""
        ratio, inverse = self._ratio(inertia)
        return ((change[-1] - ratio * (self._sum @ change[:-1])) * inverse)[self._group]

    def pull(self, inertia: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """(k + 1, ne) weights of ``inertia`` from weights (k, ne) of the scales."""
        ratio, inverse = self._ratio(inertia)
        grouped = np.zeros_like(ratio)
        np.add.at(grouped, self._group, weights)
        grouped *= inverse
        return np.vstack([-self._sum.T @ (ratio * grouped), grouped.sum(axis=0)])

    def _ratio(self, inertia: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """``m / s`` and ``1 / s`` of every direction; one and zero where there is no mass."""
        sums = self._sum @ inertia[:-1]
        none = sums == 0
        inverse = np.where(none, 0.0, 1 / np.where(none, 1.0, sums))
        return np.where(none, 1.0, inertia[-1] * inverse), inverse


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
