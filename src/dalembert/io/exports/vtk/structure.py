"""Grids of structures: nodes and finite elements with their fields."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from dalembert.elements.fem.registry import cell_of
from dalembert.io.exports.vtk.grid import Grid, State, some
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.states import StructuralStates, element_field, field_names

FRAMES = 200
"""Upper limit of instants by default."""


def structure_states(result: StructuralStates, frames: int | None) -> Iterator[State]:
    """A grid of each state, with undeformed points."""
    drawing = StructuralDrawing(result.model, result.parameters)
    cells = [
        (_shape(block), np.asarray(block.nodes).T.astype(int)) for block in result.model.blocks
    ]
    limit = frames or (FRAMES if result.in_sequence else len(result.cases))
    time = np.asarray(result.time if result.in_sequence else np.arange(len(result.cases)))
    for k in some(len(result.cases), limit):
        grid = Grid(drawing.nodes.astype(float), cells, _nodal(result, drawing, k))
        grid.cell_data = _elements(result, drawing, k)
        yield State(float(time[k]), {"elements": grid})


def _shape(block: Any) -> str:
    return cell_of(block.kind.cls)


def _nodal(result: Any, drawing: StructuralDrawing, k: int) -> dict[str, np.ndarray]:
    """Displacements, rotations, velocities, accelerations and external forces of nodes."""
    data = {"displacement": drawing.translations(result.displacements[:, k])}
    if result.model.degrees.table.shape[1] > drawing.dimension:
        data["rotation"] = drawing.rotations(result.displacements[:, k])
    for name, attribute in (("velocity", "velocities"), ("acceleration", "accelerations")):
        if attribute in vars(result):
            data[name] = drawing.translations(getattr(result, attribute)[:, k])
    data["external_force"] = drawing.translations(result.forces[:, k])
    return data


def _elements(
    result: StructuralStates, drawing: StructuralDrawing, k: int
) -> dict[str, list[np.ndarray]]:
    """Every quantity of the elements, NaN for elements without it."""
    state, data = result.state(k), {}
    for name in field_names(result.strained)[1:]:
        field = element_field(drawing, state, name, result.strained)
        data[name] = np.split(field.values, drawing.starts[1:-1])
    return data
