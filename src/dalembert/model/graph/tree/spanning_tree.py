"""Graph of bodies and joints: spanning trees, connectivity and closed loops."""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from functools import cached_property
from itertools import count

from dalembert.elements.base import Constraint
from dalembert.elements.body import BodyElement
from dalembert.elements.driver import Driver
from dalembert.elements.pair import Pair


@dataclass(frozen=True)
class Edge:
    """A joint as an edge between two bodies.

    Attributes
    ----------
    weight : edges of smallest weight are selected first
    """

    name: str
    i: str
    j: str
    weight: int = 0


@dataclass(frozen=True)
class Visit:
    """A node with its parent and the edge to it; a root has neither."""

    node: str
    parent: str | None = None
    edge: str | None = None


@dataclass(frozen=True)
class SpanningTree:
    """Nodes in an order with parents first, and the edges that close loops."""

    visits: tuple[Visit, ...]
    chords: tuple[Edge, ...]

    @cached_property
    def _arrivals(self) -> dict[str, tuple[int, Visit]]:
        """Node → depth in its tree, and visit."""
        arrivals: dict[str, tuple[int, Visit]] = {}
        for visit in self.visits:
            depth = 0 if visit.parent is None else arrivals[visit.parent][0] + 1
            arrivals[visit.node] = depth, visit
        return arrivals

    @property
    def roots(self) -> list[str]:
        return [visit.node for visit in self.visits if visit.parent is None]

    def loop(self, chord: Edge) -> tuple[str, ...]:
        """Edges of the loop closed by an edge outside of the tree, in order."""
        i, j = chord.i, chord.j
        from_i: list[str] = []
        from_j: list[str] = []
        while i != j:
            (depth_i, visit_i), (depth_j, visit_j) = self._arrivals[i], self._arrivals[j]
            if depth_i >= depth_j:
                i = _to_parent(visit_i, from_i)
            else:
                j = _to_parent(visit_j, from_j)
        return (*reversed(from_i), chord.name, *from_j)


def _to_parent(visit: Visit, path: list[str]) -> str:
    """The parent of a node; the edge to it is appended to the path."""
    assert visit.parent is not None and visit.edge is not None
    path.append(visit.edge)
    return visit.parent


def spanning_tree(nodes: list[str], edges: list[Edge]) -> SpanningTree:
    """Grow a tree from the first node, and further ones from unreached nodes.

    The lightest edge that leaves the tree is selected next, among equal ones the one nearest to the
    root: with equal weights this is the breadth-first tree.
    """
    neighbours: dict[str, list[tuple[str, Edge]]] = {name: [] for name in nodes}
    for edge in edges:
        neighbours[edge.i].append((edge.j, edge))
        neighbours[edge.j].append((edge.i, edge))
    visits: list[Visit] = []
    visited: set[str] = set()
    arrival = count()
    for root in nodes:
        waiting: list[tuple[int, int, int, Visit]] = [(0, 0, next(arrival), Visit(root))]
        while waiting:
            _, depth, _, visit = heapq.heappop(waiting)
            if visit.node in visited:
                continue
            visited.add(visit.node)
            visits.append(visit)
            for neighbour, edge in neighbours[visit.node]:
                if neighbour not in visited:
                    visit_of_neighbour = Visit(neighbour, visit.node, edge.name)
                    heapq.heappush(
                        waiting, (edge.weight, depth + 1, next(arrival), visit_of_neighbour)
                    )
    tree_edges = {visit.edge for visit in visits}
    return SpanningTree(tuple(visits), tuple(e for e in edges if e.name not in tree_edges))


@dataclass(frozen=True)
class Topology:
    """Loops by joint names, and bodies without any connection."""

    loops: tuple[tuple[str, ...], ...]
    unconnected: tuple[str, ...]


def analyse_topology(
    bodies: list[BodyElement], constraints: list[Constraint], touched: set[str]
) -> Topology:
    """Fundamental loops of a breadth-first spanning tree from the ground.

    Parameters
    ----------
    touched : names of bodies that any constraint or force other than gravity acts on
    """
    edges = [
        Edge(c.name, c.ends()[0].name, c.ends()[1].name)
        for c in constraints
        if isinstance(c, Pair) and not isinstance(c, Driver)
    ]
    names = [body.name for body in bodies]
    tree = spanning_tree(["ground", *names], edges)
    return Topology(
        loops=tuple(tree.loop(chord) for chord in tree.chords),
        unconnected=tuple(name for name in names if name not in touched),
    )
