"""Numbering of nodes, elements and displacements of a structure."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping

import numpy as np

from dalembert.elements.fem.node import ROTATIONS, TRANSLATIONS
from dalembert.elements.fem.sets import Nodes


class Spans:
    """``name → number``; a set has a range of numbers, its members are called ``set[k]``."""

    def __init__(self) -> None:
        self.size = 0
        self._first: dict[str, tuple[int, int | None]] = {}
        self._names: list[str] = []
        self._starts: list[int] = []

    def add(self, name: str, count: int | None = None) -> int:
        """Number an object, or a set of ``count`` members; returns the first number."""
        first = self.size
        self._first[name] = first, count
        self._names.append(name)
        self._starts.append(first)
        self.size += 1 if count is None else count
        return first

    def first(self, name: str) -> int:
        """First number of an object or set."""
        return self._first[name][0]

    def number(self, name: str) -> int | None:
        """Number of an object or of a member of a set; None for an unknown name."""
        owner, bracket, inside = name.partition("[")
        if owner not in self._first:
            return None
        first, count = self._first[owner]
        if count is None or not bracket:
            return first if count is None and not bracket else None
        inside = inside.removesuffix("]")
        return first + int(inside) if inside.isdigit() and int(inside) < count else None

    def numbers(self, name: str) -> range | None:
        """All numbers of an object or set; None for an unknown name."""
        if name not in self._first:
            number = self.number(name)
            return None if number is None else range(number, number + 1)
        first, count = self._first[name]
        return range(first, first + (1 if count is None else count))

    def name(self, number: int) -> str:
        """Name of the object or member with this number."""
        owner = self._names[bisect_right(self._starts, number) - 1]
        first, count = self._first[owner]
        return owner if count is None else f"{owner}[{number - first}]"

    @property
    def names(self) -> list[str]:
        """Names of all objects and members."""
        return [self.name(k) for k in range(self.size)]

    @property
    def owners(self) -> list[str]:
        """Names of the objects and sets."""
        return list(self._names)

    def __contains__(self, name: str) -> bool:
        return self.number(name) is not None

    def __len__(self) -> int:
        return self.size


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
