"""Graph of bodies and joints: spanning trees, connectivity and closed loops."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.elements.base import Constraint
from dalembert.elements.body import BodyElement
from dalembert.elements.driver import Driver
from dalembert.elements.pair import Pair
from dalembert.model.tree.spanning_tree import Edge, spanning_tree


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
