"""What is told of the states of a structure in one view."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.results.structural.states import StructuralStates


def structural_summary(result: StructuralStates) -> dict[str, Any]:
    """Status, and the largest displacement and the sum of the reactions of each state."""
    made: dict[str, Any] = {
        "status": str(result.status),
        "residual": result.status.residual,
        "statistics": result.statistics,
        "warnings": list(result.warnings),
    }
    numbers = {name: result.values(name) for name in result.named}
    rows = []
    for k, label in enumerate(result.state_names):
        row: dict[str, Any] = {result.kind_of_state: label}
        row |= {name: float(values[k]) for name, values in numbers.items()}
        if not result.of_any_size:
            row["largest displacement"] = _largest(result, k)
            row["sum of reactions"] = _reactions(result, k)
        rows.append(row)
    made["states"] = rows
    if len(rows) == 1:
        totals = {name: result.values(name) for name in result.totals}
        made["totals"] = {name: float(value[0]) for name, value in totals.items()}
    return made


def _largest(result: StructuralStates, k: int) -> dict[str, Any]:
    """Size and node of the largest displacement."""
    degrees = result.model.degrees
    table = degrees.table[:, : degrees.dimension]
    size = np.linalg.norm(np.where(table >= 0, result.displacements[table, k], 0.0), axis=1)
    node = int(np.argmax(size))
    return {"value": float(size[node]), "unit": "m", "node": degrees.nodes.name(node)}


def _reactions(result: StructuralStates, k: int) -> dict[str, float]:
    """Sum of the forces of the supports along each direction [N]."""
    degrees, held = result.model.degrees, result.model.assembly.prescribed
    found = {}
    for axis, direction in enumerate(degrees.directions[: degrees.dimension]):
        numbers = np.intersect1d(degrees.table[:, axis], held)
        found[direction.replace("u", "f", 1)] = float(result.forces[numbers, k].sum())
    return found
