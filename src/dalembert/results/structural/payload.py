"""Payload of the report of a structure: scene, states, fields, diagrams and tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.results.files.tables import diagnosis, parameter_rows, preferred_units, statistics
from dalembert.results.structural.diagrams import line_diagrams
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.formulas import with_formulas
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
        data = [block.data(result.parameters) for block in model.blocks]
        scene["diagrams"] = line_diagrams(drawing, drawing.nodes, data)
    payload = {
        "format": 2,
        "kind": "structure",
        "title": model.name,
        "subtitle": result.analysis.display_name,
        "states": {
            "kind": result.kind_of_state,
            "names": [result.state_names[k] for k in keep],
            "times": result.time[keep] if result.in_sequence else [],
            "relative": result.of_any_size,
            **_labels(result, keep),
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
    if model.parameters and len(keep) == count and not result.analysis.live_obstacle(result):
        return with_formulas(payload, result, drawing)
    return payload


def _labels(result: StructuralStates, keep: Any) -> dict[str, Any]:
    """Numbers of the states, and the measure that their names state."""
    labels: dict[str, Any] = {"numbers": result.time[keep]}
    if result.of_any_size:
        unit = result.expression(result.main).unit
        labels |= {"unit": unit, "values": result.values(result.main)[keep]}
    return labels


def _fields(
    result: StructuralStates, drawing: StructuralDrawing, quantities: list[str], keep: Any
) -> list[dict[str, Any]]:
    """Quantities of the elements by case; null for elements without the quantity."""
    entries: list[dict[str, Any]] = []
    for name in quantities:
        states = (result.state(int(case)) for case in keep)
        fields = [element_field(drawing, state, name, result.strained) for state in states]
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
        (result.kinds_of_state, len(result.cases)),
    ]
    messages = [("warning", text) for text in result.warnings]
    if omitted:
        note = "are left out of this page; the result file has them all"
        messages.append(("info", f"{omitted} {result.kinds_of_state} {note}"))
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
