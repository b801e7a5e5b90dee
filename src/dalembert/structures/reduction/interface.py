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
    """Nodes that move as one rigid section; a single node without rotations only translates.

    Attributes
    ----------
    name : str
    nodes : numbers of its nodes
    place : (d,) its reference point, the mean of its nodes [m]
    degrees : (k,) numbers of its displacements
    motions : (k, c) these displacements for unit motions: translations, then rotations
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
    selections: GivenInterfaces, degrees: Numbering, places: np.ndarray
) -> list[Interface]:
    """Interfaces from name → nodes, or from nodes, each with its own name.

    Raises
    ------
    ModelError
        Unknown node, or a node in two interfaces.
    """
    if not isinstance(selections, Mapping):
        if isinstance(selections, (str, Node)):
            selections = [selections]
        selections = {(node if isinstance(node, str) else node.name): node for node in selections}
    interfaces, used = [], np.zeros(len(degrees.table), dtype=bool)
    for name, selection in selections.items():
        nodes = _numbers(name, selection, degrees)
        if used[nodes].any():
            both = degrees.nodes.name(int(nodes[np.argmax(used[nodes])]))
            raise ModelError(f"holds {both}, which another interface holds too", str(name))
        used[nodes] = True
        interfaces.append(_interface(name, nodes, degrees, places))
    return interfaces


def _interface(name: str, nodes: np.ndarray, degrees: Numbering, places: np.ndarray) -> Interface:
    d, place = degrees.dimension, places[nodes].mean(axis=0)
    table = degrees.table[nodes]
    numbers = np.sort(table[table >= 0])
    motions = rigid_motions(degrees, places - place)[numbers]
    if not _turns(table, places[nodes], d):
        motions = motions[:, :d]
    return Interface(name, nodes, place, numbers, motions)


def _turns(table: np.ndarray, places: np.ndarray, d: int) -> bool:
    """Whether displacements of the nodes determine the rotation of a section."""
    if (table[:, d:] >= 0).any():
        return True
    spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    return bool((spread > 1e-9 * max(spread.max(initial=0.0), 1e-300)).sum() >= d - 1)


def _numbers(name: str, selection: Chosen, degrees: Numbering) -> np.ndarray:
    if isinstance(selection, Nodes):
        return degrees.of_set(selection)
    if isinstance(selection, Node):
        selection = selection.name
    if isinstance(selection, str):
        known = degrees.nodes.numbers(selection)
        if known is None:
            raise ModelError(unknown("node", selection, degrees.nodes.owners), str(name))
        return np.array(known)
    try:
        parts = [_numbers(name, part, degrees) for part in selection]
    except TypeError:
        raise ModelError(f"an interface is made of nodes; got {selection!r}", str(name)) from None
    if not parts:
        raise ModelError("an interface needs at least one node", str(name))
    return np.unique(np.concatenate(parts))
