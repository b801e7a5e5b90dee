"""Node positions, rigid motions of a structure, and interfaces that move rigidly."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.structures.evaluation.block import ElementBlock
from dalembert.structures.evaluation.numbering import Numbering


def node_places(blocks: list[ElementBlock], degrees: Numbering, p: np.ndarray) -> np.ndarray:
    """(nodes, d) positions of the nodes at parameter values ``p`` [m]."""
    return _by_node(blocks, degrees, lambda block: block.data(p))


def push_places(
    blocks: list[ElementBlock], degrees: Numbering, p: np.ndarray, dp: np.ndarray
) -> np.ndarray:
    """(nodes, d) change of the positions with the parameters."""
    return _by_node(blocks, degrees, lambda block: block.push_data(p, dp))


def pull_places(
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


def rigid_motions(degrees: Numbering, places: np.ndarray) -> np.ndarray:
    """(n, d + rotations) displacements of translations and small rotations about the origin."""
    d, spin_matrices = degrees.dimension, spins(degrees.dimension)
    motions = np.zeros((len(degrees), d + len(spin_matrices)))
    translations = degrees.table[:, :d]
    for k in range(d):
        motions[translations[:, k], k] = 1.0
    for k, spin in enumerate(spin_matrices):
        motions[translations, d + k] = places @ spin.T
        rotation = degrees.table[:, d + k]
        motions[rotation[rotation >= 0], d + k] = 1.0
    return motions


def uncarried(degrees: Numbering, weights: np.ndarray) -> np.ndarray:
    """(n, k) weights of shapes from weights (n, k · rotations) of the result of ``carried``."""
    d, spin_matrices = degrees.dimension, spins(degrees.dimension)
    translations = degrees.table[:, :d]
    total = np.zeros((len(weights), weights.shape[1] // len(spin_matrices)))
    for part, spin in zip(
        np.split(weights, len(spin_matrices), axis=1), spin_matrices, strict=True
    ):
        total[translations] += np.einsum("ij,nik->njk", spin, part[translations])
    return total


def carried(degrees: Numbering, shapes: np.ndarray) -> np.ndarray:
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
