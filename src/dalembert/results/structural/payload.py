"""Payload of the report of a structure: scene, states, fields, diagrams and tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.fem.space_frame import SpaceFrame
from dalembert.elements.look import Diagram
from dalembert.model.assembled.evaluation.block import ElementBlock
from dalembert.results.files.tables import diagnosis, parameter_rows, preferred_units, statistics
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.scene import automatic_scale, structural_scene
from dalembert.results.structural.states import StructuralStates, element_field, field_names

MOST_NUMBERS = 3_000_000
"""Upper limit of the numbers in a page; surplus states are omitted evenly."""


def structural_payload(result: StructuralStates, units: Sequence[str] = ()) -> dict[str, Any]:
    """Payload of the page of a structural result.

    Parameters
    ----------
    result : StructuralStates
    units : preferred units of the page, one per dimension
    """
    drawing = StructuralDrawing(result.model, result.parameters)
    model, degrees = result.model, result.model.degrees
    quantities = field_names(model)[1:]
    numbers_per_case = (
        3 * len(drawing.rest) + len(quantities) * int(drawing.starts[-1]) + len(degrees)
    )
    count = len(result.cases)
    fit = max(1, min(count, MOST_NUMBERS // max(numbers_per_case, 1)))
    keep = np.unique(np.linspace(0, max(count - 1, 0), fit).round().astype(int))[:count]
    displacements = [drawing.displaced(result.displacements[:, k], result.large) for k in keep]
    scales = [automatic_scale(drawing, m) for m in displacements]
    if displacements and not result.of_any_size:
        largest = max(displacements, key=lambda m: float(np.abs(m).max(initial=0.0)))
        scales = [automatic_scale(drawing, largest)] * len(displacements)
    loads = np.reshape([result.applied(int(k)) for k in keep], (len(keep), len(degrees))).T
    scene = structural_scene(drawing, displacements, scales, loads)
    scene["fields"] = _fields(result, drawing, quantities, keep)
    if not result.of_any_size:
        scene["diagrams"] = line_diagrams(drawing, result.parameters)
    return {
        "format": 2,
        "kind": "structure",
        "title": model.name,
        "subtitle": result.analysis.display_name,
        "states": {
            "kind": result.kind_of_state,
            "names": [result.state_names[k] for k in keep],
            "times": result.time[keep] if result.in_sequence else [],
            "relative": result.of_any_size,
        },
        "scene": scene,
        "directions": list(degrees.directions),
        "numbers": degrees.table.ravel(),
        "displacements": [result.displacements[:, k] for k in keep],
        "reactions": _reactions(result, keep),
        "units": preferred_units(
            {"m", "rad", "N", "N m", *(field["unit"] for field in scene["fields"])}, units
        ),
        "diagnosis": _diagnosis(result, count - len(keep)),
        "statistics": _statistics(result),
        "parameters": parameter_rows(model.parameters, result.parameters, units),
    }


def _fields(
    result: StructuralStates, drawing: StructuralDrawing, quantities: list[str], keep: Any
) -> list[dict[str, Any]]:
    """Quantities of the elements by case; null for elements without the quantity."""
    entries: list[dict[str, Any]] = []
    for name in quantities:
        fields = [element_field(drawing, result.state(int(case)), name) for case in keep]
        if any(np.isfinite(field.values).any() for field in fields):
            values = [field.values for field in fields]
            entries.append({"name": name, "unit": fields[0].unit, "values": values})
    return entries


def _reactions(result: StructuralStates, keep: Any) -> list[dict[str, Any]]:
    """One row for each prescribed displacement; empty without forces."""
    if not np.any(result.forces):
        return []
    degrees = result.model.degrees
    rows = []
    for node, direction in result.model.supports:
        turns = direction.startswith("r")
        force = direction.replace("u", "f", 1) if not turns else direction.replace("r", "m", 1)
        values = result.forces[degrees[node, direction], keep]
        rows.append(
            {"node": node, "name": force, "unit": "N m" if turns else "N", "values": values}
        )
    return rows


def _diagnosis(result: StructuralStates, omitted: int) -> dict[str, Any]:
    model = result.model
    prescribed_count = len(model.supports)
    items = [
        ("dimensions", model.degrees.dimension),
        ("nodes", len(model.degrees.nodes)),
        *((block.kind.cls.__name__, block.count) for block in model.blocks),
        ("displacements", len(model.degrees)),
        ("prescribed displacements", prescribed_count),
        (f"{result.kind_of_state}s", len(result.cases)),
    ]
    messages = [("warning", text) for text in result.warnings]
    if omitted:
        note = "are left out of this page; the result file has them all"
        messages.append(("info", f"{omitted} {result.kind_of_state}s {note}"))
    elements = sum(block.count for block in model.blocks)
    counted = f"{len(model.degrees.nodes)} nodes, {elements} elements"
    summary = f"{counted}, {result.status.outcome.value}"
    return diagnosis(summary, items, messages, result.status)


def _statistics(result: StructuralStates) -> list[dict[str, str]]:
    rows: list[tuple[str, Any]] = [("status", result.status.outcome.value)]
    if result.status.residual is not None:
        rows.append(("residual, relative", float(result.status.residual)))
    rows += list(result.statistics.items())
    for name in result.totals:
        values, unit = result.values(name), result.model[name].unit
        if np.all(np.isfinite(values)) and np.any(values):
            distinct = np.unique(values) if name == "mass" else values
            text = ", ".join(f"{v:.6g}" for v in distinct[:6]) + (
                ", …" if distinct.size > 6 else ""
            )
            rows.append((f"{name.replace('_', ' ')} [{unit}]", text))
    return statistics(rows)


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
