"""Partitioned assembly (8.14): prescribed displacements first, free ones are solved for."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sparse

from dalembert.structures.block import ElementBlock


class Assembly:
    """Sums over elements, and their partition into free (f) and prescribed (p) displacements.

    Parameters
    ----------
    blocks : all elements
    size : number of displacements
    prescribed : numbers of the prescribed ones
    """

    def __init__(self, blocks: list[ElementBlock], size: int, prescribed: np.ndarray):
        self.blocks, self.size = blocks, size
        self.prescribed = np.asarray(prescribed, dtype=int)
        self.free = np.setdiff1d(np.arange(size), self.prescribed)

    @cached_property
    def _places(self) -> tuple[np.ndarray, np.ndarray]:
        """Row and column of every entry of every element matrix."""
        rows, columns = [], []
        for block in self.blocks:
            k, count = block.degrees.shape
            rows.append(np.broadcast_to(block.degrees[:, None, :], (k, k, count)).ravel())
            columns.append(np.broadcast_to(block.degrees[None, :, :], (k, k, count)).ravel())
        if not rows:
            return np.zeros(0, dtype=int), np.zeros(0, dtype=int)
        return np.concatenate(rows), np.concatenate(columns)

    def stiffness(self, u: np.ndarray, p: np.ndarray) -> sparse.csc_matrix:
        """Tangent stiffness of the whole structure, ``K`` (8.7) where it is linear."""
        parts = [b.kind.tangents(b.gather(u), b.data(p)).ravel() for b in self.blocks]
        entries = np.concatenate(parts) if parts else np.zeros(0)
        return sparse.coo_matrix((entries, self._places), shape=(self.size,) * 2).tocsc()

    def internal_forces(self, u: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(n,) forces that hold the displaced elements."""
        total = np.zeros(self.size)
        for b in self.blocks:
            total += b.scatter(b.kind.forces(b.gather(u), b.data(p)), self.size)
        return total

    def push(self, u: np.ndarray, p: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """(n,) change of the internal forces with the parameters, displacements held."""
        total = np.zeros(self.size)
        for b in self.blocks:
            change = b.kind.push(b.gather(u), b.data(p), b.push_data(p, dp))
            total += b.scatter(change, self.size)
        return total

    def pull(self, u: np.ndarray, p: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Weights of the parameters from weights (n,) of the internal forces."""
        total = np.zeros(p.size)
        for b in self.blocks:
            data = b.kind.pull(b.gather(u), b.data(p), b.gather(weights))
            total += b.pull_data(p, data)
        return total
