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
    def paths(self) -> dict[str, tuple[str, ...]]:
        """Edges from the root of its component to a node."""
        found: dict[str, tuple[str, ...]] = {}
        for visit in self.visits:
            parent, edge = visit.parent, visit.edge
            found[visit.node] = () if parent is None or edge is None else (*found[parent], edge)
        return found

    @property
    def roots(self) -> list[str]:
        return [visit.node for visit in self.visits if visit.parent is None]

    def loop(self, chord: Edge) -> tuple[str, ...]:
        """Edges of the loop that an edge outside the tree closes, once round."""
        one, other = self.paths[chord.i], self.paths[chord.j]
        shared = set(one) & set(other)
        back = [edge for edge in reversed(other) if edge not in shared]
        return (*(edge for edge in one if edge not in shared), chord.name, *back)


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
