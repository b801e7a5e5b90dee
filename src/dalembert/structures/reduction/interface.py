"""Interfaces: where a reduced structure is held, each moving as one rigid section."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.elements.fem.node import Node
from dalembert.errors import ModelError
from dalembert.structures.evaluation.numbering import Numbering
from dalembert.structures.nodes import Nodes
from dalembert.structures.reduction.rigid import rigid_motions
from dalembert.text.wording import unknown

Chosen = str | Node | Nodes | Sequence[Any]
"""A node, a set of nodes, or several of them."""
GivenInterfaces = Mapping[str, Chosen] | Sequence[str | Node]


@dataclass(frozen=True, eq=False)
class Interface:
    """Nodes that move as one rigid section; a node without rotations by itself only shifts.

    Attributes
    ----------
    name : str
    nodes : numbers of its nodes
    place : (d,) its reference point, the mean of its nodes [m]
    degrees : (k,) numbers of its displacements
    motions : (k, c) these displacements for unit motions of the section: translations, then turns
    """

    name: str
    nodes: np.ndarray
    place: np.ndarray
    degrees: np.ndarray
    motions: np.ndarray

    @property
    def turns(self) -> bool:
        """Whether it has rotations."""
        return self.motions.shape[1] > self.place.size


def interfaces_of(
    given: GivenInterfaces, degrees: Numbering, places: np.ndarray
) -> list[Interface]:
    """The interfaces that were asked for, by name → nodes, or as nodes with names of their own.

    Raises
    ------
    ModelError
        No such node, a node in two interfaces.
    """
    if not isinstance(given, Mapping):
        if isinstance(given, (str, Node)):
            given = [given]
        given = {(node if isinstance(node, str) else node.name): node for node in given}
    found, taken = [], np.zeros(len(degrees.table), dtype=bool)
    for name, chosen in given.items():
        nodes = _numbers(name, chosen, degrees)
        if taken[nodes].any():
            both = degrees.nodes.name(int(nodes[np.argmax(taken[nodes])]))
            raise ModelError(f"holds {both}, which another interface holds too", str(name))
        taken[nodes] = True
        found.append(_interface(name, nodes, degrees, places))
    return found


def _interface(name: str, nodes: np.ndarray, degrees: Numbering, places: np.ndarray) -> Interface:
    d, place = degrees.dimension, places[nodes].mean(axis=0)
    own = degrees.table[nodes]
    numbers = np.sort(own[own >= 0])
    motions = rigid_motions(degrees, places - place)[numbers]
    if not _turns(own, places[nodes], d):
        motions = motions[:, :d]
    return Interface(name, nodes, place, numbers, motions)


def _turns(table: np.ndarray, places: np.ndarray, d: int) -> bool:
    """Whether displacements of the nodes tell how a section turns."""
    if (table[:, d:] >= 0).any():
        return True
    spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    return bool((spread > 1e-9 * max(spread.max(initial=0.0), 1e-300)).sum() >= d - 1)


def _numbers(name: str, chosen: Chosen, degrees: Numbering) -> np.ndarray:
    if isinstance(chosen, Nodes):
        return degrees.of_set(chosen)
    if isinstance(chosen, Node):
        chosen = chosen.name
    if isinstance(chosen, str):
        known = degrees.nodes.numbers(chosen)
        if known is None:
            raise ModelError(unknown("node", chosen, degrees.nodes.owners), str(name))
        return np.array(known)
    try:
        parts = [_numbers(name, one, degrees) for one in chosen]
    except TypeError:
        raise ModelError(f"an interface is made of nodes; got {chosen!r}", str(name)) from None
    if not parts:
        raise ModelError("an interface needs at least one node", str(name))
    return np.unique(np.concatenate(parts))
