"""Scene of a structure as plain data: its mesh in several states, supports and loads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.elements.look import Bars, Beams, Cells
from dalembert.elements.point import AXES
from dalembert.results.structural.drawing import StructuralDrawing

SHARE = 0.08
"""Drawn size of the maximum displacement, relative to the extent."""
LARGE = 0.02
"""Threshold, relative to the extent, for drawing displacements to scale."""
DROP = 0.12
"""Distance of one-dimensional structures below the undeformed one, relative to the extent."""
MAX_ARROWS = 80
"""Threshold of nodes above which distributed loads are not drawn."""


def structural_scene(
    drawing: StructuralDrawing,
    displacements: Sequence[np.ndarray],
    scales: Sequence[float],
    loads: np.ndarray,
) -> dict[str, Any]:
    """Scene of a structure; the columns of its symbols are over the states.

    Parameters
    ----------
    drawing : StructuralDrawing
    displacements : (vertices, 3) displacements of each state [m]
    scales : factors that make them visible
    loads : (n, states) applied forces on the displacements
    """
    height = float(np.ptp(drawing.rest[:, 1])) if len(drawing.rest) else 0.0
    mesh = {
        "rest": drawing.rest.ravel(),
        "lines": _cells(drawing.lines),
        "faces": _cells(drawing.faces),
        "points": _cells(drawing.points),
        "outline": drawing.outline().ravel(),
        "nodes": drawing.model.degrees.nodes.names,
        "elements": drawing.element_names,
        "vertex_displacements": [moved.ravel() for moved in displacements],
        "scales": list(scales),
        "drop": height + DROP * drawing.extent if drawing.dimension == 1 else 0.0,
    }
    symbols = [*support_symbols(drawing), *load_symbols(drawing, loads)]
    return {"dimension": drawing.dimension, "mesh": mesh, "symbols": symbols}


def automatic_scale(drawing: StructuralDrawing, moved: np.ndarray) -> float:
    """Round scale factor (1, 2 or 5 times a power of ten) that makes displacements visible."""
    largest = float(np.linalg.norm(moved, axis=1).max(initial=0.0))
    if not largest > 0 or not np.isfinite(largest):
        return 1.0
    if LARGE * drawing.extent <= largest <= drawing.extent:
        return 1.0
    target = SHARE * drawing.extent / largest
    power = 10.0 ** np.floor(np.log10(target))
    return float(power * max(m for m in (1, 2, 5) if m * power <= target * (1 + 1e-9)))


def _cells(group: Sequence[Cells]) -> list[dict[str, Any]]:
    return [
        {"size": c.vertices.shape[1], "vertices": c.vertices.ravel(), "elements": c.elements}
        for c in group
        if len(c.elements)
    ]


# supports ---------------------------------------------------------------------------------------
def support_symbols(drawing: StructuralDrawing) -> list[dict[str, Any]]:
    """Supports by the direction in which they lie, whether they roll, and whether they clamp."""
    groups: dict[tuple, list[int]] = {}
    for node, axis in (_outward(drawing) | _beside_lines(drawing)).items():
        groups.setdefault(_support(drawing, axis, drawing.prescribed[node]), []).append(node)
    return [
        {"symbol": "support", "nodes": nodes, "axis": list(axis), "roller": roller, "clamp": clamp}
        for (axis, roller, clamp), nodes in groups.items()
    ]


def _outward(drawing: StructuralDrawing) -> dict[int, tuple[int, ...]]:
    """Outward axis direction of each supported node.

    Nodes in a corner belong to the side with more nodes; to the lower one in case of a tie.
    """
    nodes, d = sorted(drawing.prescribed), max(2, drawing.dimension)
    if not nodes:
        return {}
    sides = [tuple(-int(k == i) for k in range(d)) for i in reversed(range(d))]
    sides += [tuple(-k for k in side) for side in reversed(sides)]
    low, high = drawing.nodes[:, :d].min(axis=0), drawing.nodes[:, :d].max(axis=0)
    shares = (drawing.nodes[nodes, :d] - low) / np.maximum(high - low, 1e-12 * drawing.extent)
    away = np.round(np.concatenate([shares.T[::-1], 1 - shares.T]), 6)
    nearest = away == away.min(axis=0)
    count = np.where(nearest, nearest.sum(axis=1, keepdims=True), -1)
    return {n: sides[k] for n, k in zip(nodes, np.argmax(count, axis=0), strict=True)}


def _beside_lines(drawing: StructuralDrawing) -> dict[int, tuple[int, ...]]:
    """Axis direction away from the lines at each node with prescribed rotations."""
    d = max(2, drawing.dimension)
    along = np.zeros((drawing.node_count, 3))
    for look in drawing.model.look():
        if isinstance(look, Bars | Beams):
            chord = np.diff(drawing.nodes[look.vertices], axis=1)[:, 0]
            chord /= np.maximum(np.linalg.norm(chord, axis=1, keepdims=True), 1e-300)
            np.add.at(along, look.vertices[:, 0], chord)
            np.subtract.at(along, look.vertices[:, 1], chord)
    away = -along[:, :d]
    turned = [n for n, prescribed in drawing.prescribed.items() if {"rz"} & prescribed]
    result = {}
    for node in turned:
        axis = int(np.argmax(np.abs(away[node])))
        sign = int(np.sign(np.round(away[node, axis], 6)))
        if sign:
            result[node] = tuple(sign * int(k == axis) for k in range(d))
    return result


def _support(
    drawing: StructuralDrawing, axis: tuple[int, ...], prescribed: set[str]
) -> tuple[tuple[int, ...], bool, bool]:
    """Axis of the symbol, whether it rolls, and whether it prevents rotations.

    A roller stands across its only free translation.
    """
    d = drawing.dimension
    free = [k for k in range(d) if f"u{'xyz'[k]}" not in prescribed]
    if d == 1:
        axis = (0, -1)
    elif len(free) == 1 and axis[free[0]]:
        axis = tuple(-int(k == (0 if free[0] else d - 1)) for k in range(len(axis)))
    rotations = {"rx", "ry", "rz"} if d == 3 else {"rz"}
    return axis, len(free) == 1, rotations <= prescribed


# loads ------------------------------------------------------------------------------------------
def load_symbols(drawing: StructuralDrawing, loads: np.ndarray) -> list[dict[str, Any]]:
    """Arrows of forces and moments, which are arcs in the plane, at nodes.

    An arrow is ``inward``, with its head at the node, where the forces of its direction push. Loads
    on nearly all nodes, such as weight, are left out.

    Parameters
    ----------
    loads : (n, states) forces and moments on the displacements
    """
    numbers = drawing.model.degrees.table
    nodal = np.where((numbers >= 0)[..., None], loads[numbers], 0.0)  # (nodes, directions, states)
    d = drawing.dimension
    force = np.zeros((len(numbers), 3, loads.shape[1]))
    force[:, :d] = nodal[:, :d]
    size = np.linalg.norm(force, axis=1)
    loaded = np.flatnonzero((size > 1e-9 * size.max(axis=0, initial=0.0)).any(axis=1))
    if loaded.size > MAX_ARROWS and loaded.size > len(numbers) / 3:
        loaded = loaded[:0]
    inward = _inward(drawing, loaded, force[loaded])
    symbols: list[dict[str, Any]] = []
    for row, node in enumerate(loaded):
        columns = {f"force_{AXES[k]}": force[node, k] for k in range(max(2, d))}
        symbol = {"symbol": "arrow", "description": "load", "node": int(node), **columns}
        symbols.append(symbol | {"inward": inward[row]})
    moment = nodal[:, d : {1: 1, 2: 3, 3: 6}[d]]  # about z in the plane, about x, y, z in space
    largest = np.abs(moment).max(initial=0.0)
    turned = np.flatnonzero((np.abs(moment) > 1e-9 * largest).any(axis=(1, 2)))
    names = ["moment"] if d == 2 else [f"moment_{axis}" for axis in AXES]
    for node in turned if turned.size <= MAX_ARROWS else ():
        columns = dict(zip(names, moment[node], strict=False))
        symbols.append({"symbol": "twist", "description": "load", "node": int(node), **columns})
    return symbols


def _inward(drawing: StructuralDrawing, nodes: np.ndarray, force: np.ndarray) -> np.ndarray:
    """(k, states) whether forces (k, 3, states) push: 1 or 0; parallel forces do alike."""
    result = np.zeros((len(nodes), force.shape[2]))
    if not result.size:
        return result
    centre = drawing.nodes.mean(axis=0) - drawing.nodes[nodes]
    largest = np.linalg.norm(force, axis=1).max(axis=0)
    scaled = np.round(force / np.where(largest > 0, largest, 1.0), 9)
    patterns, state = np.unique(scaled.reshape(-1, force.shape[2]), axis=1, return_inverse=True)
    for k, pattern in enumerate(patterns.T):
        vectors = pattern.reshape(-1, 3)
        length = np.linalg.norm(vectors, axis=1, keepdims=True)
        unit = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0)
        _, group = np.unique(np.round(unit, 6), axis=0, return_inverse=True)
        work = np.bincount(group.ravel(), np.einsum("ij,ij->i", vectors, centre))[group.ravel()]
        result[:, state.ravel() == k] = (work > 1e-9 * drawing.extent)[:, None]
    return result
