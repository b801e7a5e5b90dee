"""Diagrams of section forces along the lines of a structure, as plain data."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.fem.space_frame import SpaceFrame
from dalembert.elements.look import Diagram
from dalembert.model.assembled.evaluation.block import ElementBlock
from dalembert.results.structural.drawing import StructuralDrawing


def line_diagrams(drawing: StructuralDrawing, p: np.ndarray) -> list[dict[str, Any]]:
    """Diagrams of each block of lines: measures at the ends, and directions across the lines.

    Parameters
    ----------
    drawing : StructuralDrawing
    p : (np,) parameter values
    """
    if drawing.dimension == 1:
        return []
    rows = []
    for block, first in zip(drawing.model.blocks, drawing.starts, strict=False):
        diagrams = block.kind.cls.diagrams
        axes = _axes(drawing, block, p) if diagrams else np.zeros(0)
        for name, diagram in diagrams.items():
            rows.append(_row(name, diagram, first + np.arange(block.count), axes))
    return rows


def _row(name: str, diagram: Diagram, elements: np.ndarray, axes: np.ndarray) -> dict[str, Any]:
    across = np.sign(diagram.across) * axes[:, :, abs(diagram.across)]
    ends = {"start": diagram.start, "end": diagram.end, "sign": diagram.sign}
    return {"name": name, **ends, "elements": elements, "across": across.ravel() + 0.0}


def _axes(drawing: StructuralDrawing, block: ElementBlock, p: np.ndarray) -> np.ndarray:
    """(ne, 3, 3) axes of undeformed lines as columns; y is to the left in the plane."""
    ends = drawing.nodes[block.nodes]  # (2, ne, 3)
    orientation = np.tile([[0.0], [0.0], [0.0]], block.count)
    if drawing.dimension == 2:
        chord = ends[1] - ends[0]
        orientation = np.stack([-chord[:, 1], chord[:, 0], 0 * chord[:, 0]])
    row = 2 * drawing.dimension
    for field in block.kind.cls.quantity_fields():
        if field.name == "orientation":
            orientation = block.data(p)[row : row + 3]
        row += field.metadata["size"]
    x, direction = [ca.SX.sym(f"x{k}", 3) for k in range(2)], ca.SX.sym("orientation", 3)
    axes = ca.vec(SpaceFrame.axes(x, {"orientation": direction}))
    function = ca.Function("axes", [*x, direction], [axes]).map(block.count)
    columns = function(ends[0].T, ends[1].T, orientation).full()
    return columns.T.reshape(block.count, 3, 3).transpose(0, 2, 1)
