"""Numbers of the displacements of a structure, node by node."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from dalembert.elements.fem.node import ROTATIONS, TRANSLATIONS
from dalembert.structures.nodes import Nodes
from dalembert.structures.spans import Spans


class Numbering(Mapping[tuple[str, str], int]):
    """``(node, direction) → number of the displacement``, as a table.

    Parameters
    ----------
    nodes : names of the nodes, in their order
    turning : (nodes,) whether they have rotations
    dimension : of space
    """

    def __init__(self, nodes: Spans, turning: np.ndarray, dimension: int):
        self.nodes, self.dimension = nodes, dimension
        self.directions = TRANSLATIONS[:dimension] + ROTATIONS[dimension]
        there = np.ones((turning.size, len(self.directions)), dtype=bool)
        there[:, dimension:] = turning[:, None]
        self.table = np.where(there, np.cumsum(there).reshape(there.shape) - 1, -1)
        """(nodes, directions) numbers, -1 where a node has no such displacement."""
        self._count = int(there.sum())
        self._owner, self._direction = np.nonzero(there)
        self.rotations = self._direction >= dimension
        """(displacements,) whether they are rotations."""

    @property
    def names(self) -> list[str]:
        """Of the displacements, ``"n2.uy"``."""
        return [f"{node}.{direction}" for node, direction in self]

    def place(self, degree: int) -> tuple[str, str]:
        """Node and direction of a displacement."""
        return self.nodes.name(int(self._owner[degree])), self.directions[self._direction[degree]]

    def of_nodes(self, nodes: np.ndarray, direction: str) -> np.ndarray:
        """Numbers of one displacement of many nodes, -1 where they have none."""
        return self.table[nodes, self.directions.index(direction)]

    def of_set(self, nodes: Nodes) -> np.ndarray:
        """Numbers of the nodes of a set."""
        return self.nodes.first(nodes.name) + nodes.index

    def get(self, place, default=None):
        """Number of a displacement, or the default."""
        name, direction = place
        node = self.nodes.number(name)
        if node is None or direction not in self.directions:
            return default
        found = int(self.table[node, self.directions.index(direction)])
        return default if found < 0 else found

    def __getitem__(self, place: tuple[str, str]) -> int:
        found = self.get(place)
        if found is None:
            raise KeyError(place)
        return found

    def __contains__(self, place) -> bool:
        return self.get(place) is not None

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return (self.place(k) for k in range(self._count))
