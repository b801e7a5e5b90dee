"""Lumped masses: the diagonal of the consistent mass matrix, scaled to the mass of the element.

Hinton, Rock and Zienkiewicz (Earthquake Engineering and Structural Dynamics 4, 1976): in every
direction the diagonal entries are scaled so that they add up to the mass; rotations take the mean
of the directions. For linear simplices and parallelograms these are the row sums.
"""

from __future__ import annotations

import numpy as np


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
