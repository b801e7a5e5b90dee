"""Flexible bodies in drawings of mechanisms: their sections and pieces as bodies that move rigidly.

A piece is a straight part of a line or an edge of the structure, between two of its nodes.
"""

from __future__ import annotations

import itertools
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.fem.registry import cell_of
from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.results.labelled import LabelledRecording
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.symbolic.formulas.expression import Expression

PIECES = 12
"""Pieces that a line between two corners is drawn with, at most."""
Pose = tuple[np.ndarray, np.ndarray]
"""(K, d) places and (K,) angles, or (K, 4) Euler parameters."""


def section_poses(motion: LabelledRecording, keep: np.ndarray, section: Any) -> Pose:
    """Where a section is and how it is turned."""
    turn = section.pose_angle if section.dimension == 2 else section.orientation
    place, turned = motion.columns([Expression(section.place), Expression(turn)])
    return place[keep], turned[keep]


def pieces(
    motion: LabelledRecording, keep: np.ndarray, body: FloatingFrame
) -> list[tuple[Pose, float]]:
    """Poses of the pieces, whose x axes lie along them, and their lengths."""
    shapes, d = motion.model.shapes(body, motion.parameters), body.dimension
    drawing = StructuralDrawing(shapes.structure, shapes.p)
    edges = _edges(drawing)
    axes = np.stack(
        [motion.values(Expression(body.turned(ca.SX(e))))[keep] for e in np.eye(d)], axis=2
    )
    origin, amplitudes = motion.columns(
        [Expression(body.locate(ca.SX.zeros(d))), Expression(body.amplitudes)]
    )
    amplitudes = amplitudes[keep].reshape(len(keep), -1)
    table = shapes.structure.degrees.table[:, :d]
    found = []
    for i, j in edges:
        ends = []
        for node in (i, j):
            local = drawing.rest[node, :d] - shapes.origin
            local = local + amplitudes @ shapes.displacements[table[node]].T
            ends.append(origin[keep] + np.einsum("kij,kj->ki", axes, local))
        length = float(np.linalg.norm(drawing.rest[j] - drawing.rest[i]))
        found.append(((ends[0], _along(ends[1] - ends[0])), length))
    return found


def _along(direction: np.ndarray) -> np.ndarray:
    """Angles (K,), or Euler parameters (K, 4), that turn the x axis into a direction."""
    if direction.shape[1] == 2:
        return np.unwrap(np.arctan2(direction[:, 1], direction[:, 0]))
    unit = direction / np.linalg.norm(direction, axis=1, keepdims=True)
    half = np.column_stack([1 + unit[:, 0], 0 * unit[:, 0], -unit[:, 2], unit[:, 1]])
    backwards = half[:, 0] < 1e-12
    half[backwards] = (0.0, 0.0, 0.0, 1.0)
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(half, scalar_first=True).as_quat(scalar_first=True)


def _edges(drawing: StructuralDrawing) -> list[tuple[int, int]]:
    """Node numbers of the ends of the pieces."""
    lines = [b.nodes.T for b in drawing.model.blocks if cell_of(b.kind.cls) == "line"]
    pairs = np.concatenate([np.zeros((0, 2), dtype=int), *lines, drawing.outline()])
    neighbours: dict[int, list[int]] = {}
    for i, j in pairs.tolist():
        neighbours.setdefault(i, []).append(j)
        neighbours.setdefault(j, []).append(i)
    rest = drawing.rest
    corners = {n for n, others in neighbours.items() if _is_corner(rest, n, others)}
    corners |= set() if corners else set(list(neighbours)[:1])
    found, walked = [], set()
    for corner in sorted(corners):
        for first in neighbours[corner]:
            chain = _chain(corner, first, neighbours, corners)
            if frozenset(chain[:2]) not in walked:
                walked |= {frozenset(p) for p in itertools.pairwise(chain)}
                some = np.linspace(0, len(chain) - 1, min(len(chain), PIECES + 1)).round()
                kept = [chain[int(k)] for k in some]
                found += list(itertools.pairwise(kept))
    return found


def _is_corner(rest: np.ndarray, node: int, others: list[int]) -> bool:
    """Whether lines end, meet or bend there."""
    if len(others) != 2:
        return True
    first, second = (rest[k] - rest[node] for k in others)
    cosine = first @ second / max(np.linalg.norm(first) * np.linalg.norm(second), 1e-300)
    return bool(cosine > -0.9)


def _chain(
    corner: int, first: int, neighbours: dict[int, list[int]], corners: set[int]
) -> list[int]:
    """Nodes from a corner to the next one."""
    chain = [corner, first]
    while chain[-1] not in corners:
        ahead = [n for n in neighbours[chain[-1]] if n != chain[-2]]
        chain.append(ahead[0])
    return chain
