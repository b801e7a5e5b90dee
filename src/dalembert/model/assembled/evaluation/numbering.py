"""Numbering of the displacements of a structure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from dalembert.elements.fem.nodal import ROTATIONS, TRANSLATIONS
from dalembert.elements.fem.node_set import Nodes
from dalembert.model.spans import Spans


class Numbering(Mapping[tuple[str, str], int]):
    """``(node, direction) → number of the displacement``, as a table.

    Parameters
    ----------
    nodes : names of the nodes in order
    turning : (nodes,) whether they have rotations
    dimension : of space
    """

    def __init__(self, nodes: Spans, turning: np.ndarray, dimension: int):
        self.nodes, self.dimension = nodes, dimension
        self.directions = TRANSLATIONS[:dimension] + ROTATIONS[dimension]
        present = np.ones((turning.size, len(self.directions)), dtype=bool)
        present[:, dimension:] = turning[:, None]
        self.table = np.where(present, np.cumsum(present).reshape(present.shape) - 1, -1)
        """(nodes, directions) numbers, -1 where a node has no such displacement."""
        self._count = int(present.sum())
        self._owner, self._direction = np.nonzero(present)
        self.rotations = self._direction >= dimension
        """(displacements,) whether they are rotations."""

    @property
    def names(self) -> list[str]:
        """Names of the displacements, ``"n2.uy"``."""
        return [f"{node}.{direction}" for node, direction in self]

    def place(self, degree: int) -> tuple[str, str]:
        """Node and direction of a displacement."""
        return self.nodes.name(int(self._owner[degree])), self.directions[self._direction[degree]]

    def directions_of(self, name: str) -> list[str]:
        """Directions of the displacements that a node has."""
        return [direction for direction in self.directions if (name, direction) in self]

    def of_nodes(self, nodes: np.ndarray, direction: str) -> np.ndarray:
        """Numbers of a displacement of many nodes, -1 where a node has none."""
        return self.table[nodes, self.directions.index(direction)]

    def of_set(self, nodes: Nodes) -> np.ndarray:
        """Numbers of the nodes of a set or selection."""
        return self.nodes.first(nodes.name) + nodes.index

    def get(self, place, default=None):
        """Number of a displacement, or the default."""
        name, direction = place
        node = self.nodes.number(name)
        if node is None or direction not in self.directions:
            return default
        number = int(self.table[node, self.directions.index(direction)])
        return default if number < 0 else number

    def __getitem__(self, place: tuple[str, str]) -> int:
        number = self.get(place)
        if number is None:
            raise KeyError(place)
        return number

    def __contains__(self, place) -> bool:
        return self.get(place) is not None

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return (self.place(k) for k in range(self._count))
