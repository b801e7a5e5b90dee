"""Diagrams of section forces along the lines of a structure, as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.fem.space_frame import SpaceFrame
from dalembert.elements.look import Diagram
from dalembert.model.assembled.evaluation.block import ElementBlock
from dalembert.results.structural.drawing import StructuralDrawing


def line_diagrams(
    drawing: StructuralDrawing, nodes: np.ndarray, data: Sequence[np.ndarray]
) -> list[dict[str, Any]]:
    """Diagrams of each block of lines: measures at the ends, and directions across the lines.

    Parameters
    ----------
    drawing : StructuralDrawing
    nodes : (n, 3) positions, numbers or formulas
    data : (m, ne) of each block of elements, alike
    """
    if drawing.dimension == 1:
        return []
    rows = []
    for block, columns, first in zip(drawing.model.blocks, data, drawing.starts, strict=False):
        diagrams = block.kind.cls.diagrams
        axes = _axes(drawing.dimension, block, nodes, columns) if diagrams else np.zeros(0)
        for name, diagram in diagrams.items():
            rows.append(_row(name, diagram, first + np.arange(block.count), axes))
    return rows


def _row(name: str, diagram: Diagram, elements: np.ndarray, axes: np.ndarray) -> dict[str, Any]:
    across = np.sign(diagram.across) * axes[:, :, abs(diagram.across)]
    ends = {"start": diagram.start, "end": diagram.end, "sign": diagram.sign}
    return {"name": name, **ends, "elements": elements, "across": across.ravel() + 0.0}


def _axes(dimension: int, block: ElementBlock, nodes: np.ndarray, data: np.ndarray) -> np.ndarray:
    """(ne, 3, 3) axes of undeformed lines as columns; y is to the left in the plane."""
    ends = nodes[block.nodes]  # (2, ne, 3)
    orientation = np.zeros((3, block.count))
    if dimension == 2:
        chord = ends[1] - ends[0]
        orientation = np.stack([-chord[:, 1], chord[:, 0], 0 * chord[:, 0]])
    row = 2 * dimension
    for field in block.kind.cls.quantity_fields():
        if field.name == "orientation":
            orientation = data[row : row + 3]
        row += field.metadata["size"]
    x, direction = [ca.SX.sym(f"x{k}", 3) for k in range(2)], ca.SX.sym("orientation", 3)
    axes = ca.vec(SpaceFrame.axes(x, {"orientation": direction}))
    function = ca.Function("axes", [*x, direction], [axes])
    columns = [ends[0].T, ends[1].T, orientation]
    if nodes.dtype == object:
        columns = [_matrix(part) for part in columns]
        parts = [function(*(part[:, k] for part in columns)) for k in range(block.count)]
        values = np.empty((block.count, 9), dtype=object)
        for k, part in enumerate(parts):
            for j, entry in enumerate(ca.vertsplit(ca.densify(part))):
                values[k, j] = entry
    else:
        values = function.map(block.count)(*columns).full().T
    return values.reshape(block.count, 3, 3).transpose(0, 2, 1)


def _matrix(entries: np.ndarray) -> ca.SX:
    """SX of numbers and formulas."""
    rows = (ca.horzcat(*(ca.SX(entry) for entry in row)) for row in entries)
    return ca.densify(ca.vertcat(*rows))
