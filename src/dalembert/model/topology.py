"""The graph of bodies and joints: components and closed loops."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from dalembert.elements.base import Constraint
from dalembert.elements.planar.body import Body
from dalembert.elements.planar.drivers import Driver
from dalembert.elements.planar.joint import Pair


@dataclass(frozen=True)
class Topology:
    """Loops by joint names, and bodies that nothing ties to the ground."""

    loops: tuple[tuple[str, ...], ...]
    unconnected: tuple[str, ...]


def analyse_topology(
    bodies: list[Body], constraints: list[Constraint], touched: set[str]
) -> Topology:
    """Fundamental loops of a breadth-first spanning tree that starts at the ground.

    Parameters
    ----------
    touched : names of bodies that any constraint or force other than gravity acts on
    """
    edges = [
        (c.name, c.ends()[0].name, c.ends()[1].name)
        for c in constraints
        if isinstance(c, Pair) and not isinstance(c, Driver)
    ]
    names = ["ground", *(b.name for b in bodies)]
    neighbours: dict[str, list[tuple[str, str]]] = {name: [] for name in names}
    for joint, i, j in edges:
        neighbours[i].append((j, joint))
        neighbours[j].append((i, joint))
    path: dict[str, tuple[str, ...]] = {}  # joints from the root of its component to a body
    used: set[str] = set()
    for root in neighbours:
        if root in path:
            continue
        path[root] = ()
        queue = deque([root])
        while queue:
            here = queue.popleft()
            for there, joint in neighbours[here]:
                if there not in path:
                    path[there] = (*path[here], joint)
                    used.add(joint)
                    queue.append(there)
    loops = []
    for joint, i, j in edges:
        if joint not in used:
            shared = set(path[i]) & set(path[j])
            one = [n for n in path[i] if n not in shared]
            other = [n for n in path[j] if n not in shared]
            loops.append((*one, joint, *reversed(other)))
    return Topology(
        loops=tuple(loops),
        unconnected=tuple(n for n in names[1:] if n not in touched),
    )
