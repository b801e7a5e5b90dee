"""Compiled functions of one class of elements, evaluated for many of them at once."""

from __future__ import annotations

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
