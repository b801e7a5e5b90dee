"""Spanning trees of the graph of bodies and joints."""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from functools import cached_property
from itertools import count


@dataclass(frozen=True)
class Edge:
    """A joint as an edge between two bodies.

    Attributes
    ----------
    weight : edges of least weight are taken first
    """

    name: str
    i: str
    j: str
    weight: int = 0


@dataclass(frozen=True)
class Visit:
    """A node as the tree reaches it; a root has neither parent nor edge."""

    node: str
    parent: str | None = None
    edge: str | None = None


@dataclass(frozen=True)
class SpanningTree:
    """Nodes in an order in which parents come first, and the edges that close loops."""

    visits: tuple[Visit, ...]
    chords: tuple[Edge, ...]

    @cached_property
    def _arrivals(self) -> dict[str, tuple[int, Visit]]:
        """How far from its root a node is, and how it is reached."""
        found: dict[str, tuple[int, Visit]] = {}
        for visit in self.visits:
            depth = 0 if visit.parent is None else found[visit.parent][0] + 1
            found[visit.node] = depth, visit
        return found

    @property
    def roots(self) -> list[str]:
        return [visit.node for visit in self.visits if visit.parent is None]

    def loop(self, chord: Edge) -> tuple[str, ...]:
        """Edges of the loop that an edge outside the tree closes, once round."""
        one, other = chord.i, chord.j
        forth: list[str] = []
        back: list[str] = []
        while one != other:
            (depth, here), (other_depth, there) = self._arrivals[one], self._arrivals[other]
            if depth >= other_depth:
                one = _step(here, forth)
            else:
                other = _step(there, back)
        return (*reversed(forth), chord.name, *back)


def _step(visit: Visit, passed: list[str]) -> str:
    """The parent of a node; the edge to it is noted."""
    assert visit.parent is not None and visit.edge is not None
    passed.append(visit.edge)
    return visit.parent


def spanning_tree(nodes: list[str], edges: list[Edge]) -> SpanningTree:
    """Grow a tree from the first node, and one more from every node left over.

    The lightest edge that leaves the tree is taken next, among equal ones the one nearest to the
    root: with equal weights this is the breadth-first tree.
    """
    neighbours: dict[str, list[tuple[str, Edge]]] = {name: [] for name in nodes}
    for edge in edges:
        neighbours[edge.i].append((edge.j, edge))
        neighbours[edge.j].append((edge.i, edge))
    visits: list[Visit] = []
    seen: set[str] = set()
    arrival = count()
    for root in nodes:
        waiting: list[tuple[int, int, int, Visit]] = [(0, 0, next(arrival), Visit(root))]
        while waiting:
            _, depth, _, visit = heapq.heappop(waiting)
            if visit.node in seen:
                continue
            seen.add(visit.node)
            visits.append(visit)
            for there, edge in neighbours[visit.node]:
                if there not in seen:
                    reached = Visit(there, visit.node, edge.name)
                    heapq.heappush(waiting, (edge.weight, depth + 1, next(arrival), reached))
    taken = {visit.edge for visit in visits}
    return SpanningTree(tuple(visits), tuple(e for e in edges if e.name not in taken))
