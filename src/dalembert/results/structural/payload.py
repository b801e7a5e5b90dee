"""What the report of a structure shows, as plain data: drawing, states, fields, tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.results.files.headings import chosen_units
from dalembert.results.files.page_parts import diagnosis, parameter_rows, statistics
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.fields import element_field, field_names
from dalembert.results.structural.plot import automatic_scale
from dalembert.results.structural.shapes import Shapes
from dalembert.results.structural.states import StructuralStates
from dalembert.results.structural.symbols import arrows, moments, support_symbols

MOST_NUMBERS = 3_000_000
"""Numbers in a page; of more cases than fit some are left out, evenly."""


def structural_payload(result: StructuralStates, units: Sequence[str] = ()) -> dict[str, Any]:
    """Everything the page of a structural result needs.

    Parameters
    ----------
    result : StructuralStates
    units : that the page shows, each for what has its dimension
    """
    drawing = StructuralDrawing(result.model, result.parameters)
    model, degrees = result.model, result.model.degrees
    quantities = field_names(model)[1:]
    each = 3 * len(drawing.rest) + len(quantities) * int(drawing.starts[-1]) + len(degrees)
    count = len(result.cases)
    fit = max(1, min(count, MOST_NUMBERS // max(each, 1)))
    keep = np.unique(np.linspace(0, max(count - 1, 0), fit).round().astype(int))[:count]
    moved = [drawing.displaced(result.displacements[:, k], result.large) for k in keep]
    scales = [automatic_scale(drawing, m) for m in moved]
    if moved and not result.of_any_size:
        largest = max(moved, key=lambda m: float(np.abs(m).max(initial=0.0)))
        scales = [automatic_scale(drawing, largest)] * len(moved)
    fields = _fields(result, drawing, quantities, keep)
    return {
        "format": 1,
        "kind": "structure",
        "title": model.name,
        "subtitle": result.analysis.spoken,
        "dimension": drawing.dimension,
        "cases": [result.state_names[k] for k in keep],
        "drawing": _drawing(drawing),
        "moved": [m.ravel() for m in moved],
        "scales": scales,
        "shapes_only": result.of_any_size,
        "sequence": result.in_sequence,
        "kind_of_state": result.kind_of_state,
        "nodes": degrees.nodes.names,
        "directions": list(degrees.directions),
        "table": degrees.table.ravel(),
        "displacements": [result.displacements[:, k] for k in keep],
        "elements": drawing.element_names,
        "fields": fields,
        "units": chosen_units({"m", "rad", "N", "N m", *(one["unit"] for one in fields)}, units),
        "supports": _supports(drawing),
        "loads": [_loads(drawing, result.applied(int(k))) for k in keep],
        "reactions": _reactions(result, keep),
        "diagnosis": _diagnosis(result, count - len(keep)),
        "statistics": _statistics(result),
        "parameters": parameter_rows(model.parameters, result.parameters, units),
    }


def _drawing(drawing: StructuralDrawing) -> dict[str, Any]:
    def plain(shapes: Sequence[Shapes]) -> list[dict[str, Any]]:
        return [
            {"size": s.vertices.shape[1], "vertices": s.vertices.ravel(), "owners": s.owners}
            for s in shapes
            if len(s.owners)
        ]

    return {
        "rest": drawing.rest.ravel(),
        "lines": plain(drawing.lines),
        "faces": plain(drawing.faces),
        "points": plain(drawing.points),
        "outline": drawing.outline().ravel(),
    }


def _fields(
    result: StructuralStates, drawing: StructuralDrawing, quantities: list[str], keep: Any
) -> list[dict[str, Any]]:
    """Quantities of the elements, case by case; null where an element has none."""
    found: list[dict[str, Any]] = []
    for name in quantities:
        fields = [element_field(drawing, result.state(int(case)), name) for case in keep]
        if any(np.isfinite(one.values).any() for one in fields):
            values = [one.values for one in fields]
            found.append({"name": name, "unit": fields[0].unit, "values": values})
    return found


def _supports(drawing: StructuralDrawing) -> list[dict[str, Any]]:
    return [
        {"nodes": nodes, "way": list(way), "roller": roller, "turns": turns}
        for (way, roller, turns), nodes in support_symbols(drawing).items()
    ]


def _loads(drawing: StructuralDrawing, loads: np.ndarray) -> list[dict[str, Any]]:
    found = [
        {"node": int(n), "force": f, "presses": bool(p)}
        for n, f, p in zip(*arrows(drawing, loads), strict=True)
    ]
    turned = moments(drawing, loads).items()
    return found + [{"node": n, "force": [0.0] * 3, "moment": m} for n, m in turned]


def _reactions(result: StructuralStates, keep: Any) -> list[dict[str, Any]]:
    """One row for each prescribed displacement; none where no forces are known."""
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


def _diagnosis(result: StructuralStates, left_out: int) -> dict[str, Any]:
    model = result.model
    held = len(model.supports)
    items = [
        ("dimensions", model.degrees.dimension),
        ("nodes", len(model.degrees.nodes)),
        *((block.kind.cls.__name__, block.count) for block in model.blocks),
        ("displacements", len(model.degrees)),
        ("prescribed displacements", held),
        (f"{result.kind_of_state}s", len(result.cases)),
    ]
    messages = [("warning", text) for text in result.warnings]
    if left_out:
        kept = "are left out of this page; the result file has them all"
        messages.append(("info", f"{left_out} {result.kind_of_state}s {kept}"))
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
            shown = np.unique(values) if name == "mass" else values
            text = ", ".join(f"{v:.6g}" for v in shown[:6]) + (", …" if shown.size > 6 else "")
            rows.append((f"{name.replace('_', ' ')} [{unit}]", text))
    return statistics(rows)
