"""Node positions, rigid motions of a structure, and interfaces that move rigidly."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.elements.fem.node import Node
from dalembert.elements.fem.node_set import Nodes
from dalembert.errors import ModelError
from dalembert.model.assembled.evaluation.block import ElementBlock
from dalembert.model.assembled.evaluation.numbering import Numbering
from dalembert.text.wording import unknown


def node_positions(blocks: list[ElementBlock], degrees: Numbering, p: np.ndarray) -> np.ndarray:
    """(nodes, d) positions of the nodes at parameter values ``p`` [m]."""
    return _by_node(blocks, degrees, lambda block: block.data(p))


def push_positions(
    blocks: list[ElementBlock], degrees: Numbering, p: np.ndarray, dp: np.ndarray
) -> np.ndarray:
    """(nodes, d) change of the positions with the parameters."""
    return _by_node(blocks, degrees, lambda block: block.push_data(p, dp))


def pull_positions(
    blocks: list[ElementBlock], degrees: Numbering, p: np.ndarray, weights: np.ndarray
) -> np.ndarray:
    """Weights (np,) of the parameters from weights (nodes, d) of the positions."""
    remaining, p_bar = weights.copy(), np.zeros(p.size)
    for block in blocks:
        n, d = block.nodes.shape[0], degrees.dimension
        data = np.zeros((block.kind.data_count, block.count))
        for k, nodes in enumerate(block.nodes):
            _, first = np.unique(nodes, return_index=True)  # each node counts once
            data[k * d : (k + 1) * d, first] = remaining[nodes[first]].T
            remaining[nodes] = 0.0
        if n and data.any():
            p_bar += block.pull_data(p, data)
    return p_bar


def _by_node(
    blocks: list[ElementBlock],
    degrees: Numbering,
    data: Callable[[ElementBlock], np.ndarray],
) -> np.ndarray:
    """(nodes, d) values from element data, whose first rows belong to the nodes."""
    values = np.zeros((len(degrees.table), degrees.dimension))
    for block in blocks:
        n, d = block.nodes.shape[0], degrees.dimension
        values[block.nodes] = data(block)[: n * d].reshape(n, d, -1).transpose(0, 2, 1)
    return values


def spins(dimension: int) -> np.ndarray:
    """(rotations, d, d) ``S_k`` with ``e_k × x = S_k x``."""
    third = np.array([[0.0, -1.0], [1.0, 0.0]])
    if dimension == 2:
        return third[None]
    matrices = np.zeros((3, 3, 3))
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        matrices[k][np.ix_([i, j], [i, j])] = third
    return matrices


def rigid_motions(degrees: Numbering, positions: np.ndarray) -> np.ndarray:
    """(n, d + rotations) displacements of translations and small rotations about the origin."""
    d, spin_matrices = degrees.dimension, spins(degrees.dimension)
    motions = np.zeros((len(degrees), d + len(spin_matrices)))
    translations = degrees.table[:, :d]
    for k in range(d):
        motions[translations[:, k], k] = 1.0
    for k, spin in enumerate(spin_matrices):
        motions[translations, d + k] = positions @ spin.T
        rotation = degrees.table[:, d + k]
        motions[rotation[rotation >= 0], d + k] = 1.0
    return motions


def carry_transposed(degrees: Numbering, weights: np.ndarray) -> np.ndarray:
    """(n, k) weights of shapes from weights (n, k · rotations) of the result of ``carry``."""
    d, spin_matrices = degrees.dimension, spins(degrees.dimension)
    translations = degrees.table[:, :d]
    total = np.zeros((len(weights), weights.shape[1] // len(spin_matrices)))
    for part, spin in zip(
        np.split(weights, len(spin_matrices), axis=1), spin_matrices, strict=True
    ):
        total[translations] += np.einsum("ij,nik->njk", spin, part[translations])
    return total


def carry(degrees: Numbering, shapes: np.ndarray) -> np.ndarray:
    """(n, k · rotations) velocities ``e_j × φ_k`` of displaced nodes in a rotating frame.

    ``e_1 × φ_1, e_1 × φ_2, …``, then ``e_2 × φ_1, …``
    """
    d = degrees.dimension
    translations = degrees.table[:, :d]
    displacements = shapes[translations]
    parts = []
    for spin in spins(d):
        part = np.zeros_like(shapes)
        part[translations] = np.einsum("ij,njk->nik", spin, displacements)
        parts.append(part)
    return np.concatenate(parts, axis=1)


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
    selections: GivenInterfaces, degrees: Numbering, positions: np.ndarray
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
        interfaces.append(_interface(name, nodes, degrees, positions))
    return interfaces


def _interface(
    name: str, nodes: np.ndarray, degrees: Numbering, positions: np.ndarray
) -> Interface:
    d, place = degrees.dimension, positions[nodes].mean(axis=0)
    table = degrees.table[nodes]
    numbers = np.sort(table[table >= 0])
    motions = rigid_motions(degrees, positions - place)[numbers]
    if not _turns(table, positions[nodes], d):
        motions = motions[:, :d]
    return Interface(name, nodes, place, numbers, motions)


def _turns(table: np.ndarray, positions: np.ndarray, d: int) -> bool:
    """Whether displacements of the nodes determine the rotation of a section."""
    if (table[:, d:] >= 0).any():
        return True
    spread = np.linalg.svd(positions - positions.mean(axis=0), compute_uv=False)
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
        raise ModelError(f"an interface consists of nodes, got {selection!r}", str(name)) from None
    if not parts:
        raise ModelError("an interface needs at least one node", str(name))
    return np.unique(np.concatenate(parts))
