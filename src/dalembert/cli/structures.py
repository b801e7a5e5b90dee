"""What the commands write and tell of a structure's results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.cli.console import console, head, shown, tell
from dalembert.cli.parameters import parameters, print_parameters

if TYPE_CHECKING:
    from dalembert.results.structural.outputs import StructuralOutputs
    from dalembert.structures.model import StructuralModel

SHOWN = 20
"""Rows of a table that are printed."""


def description(model: StructuralModel) -> dict[str, Any]:
    """What a structure consists of, and its parameters."""
    return {
        "dimension": model.degrees.dimension,
        "nodes": len(model.degrees.nodes),
        "elements": {block.kind.cls.__name__: block.count for block in model.blocks},
        "displacements": len(model.degrees),
        "prescribed": len(model.supports),
        "load_cases": list(model.loads),
        "parameters": parameters(model),
    }


def sentence(model: StructuralModel) -> str:
    """The same in one line."""
    made = description(model)
    elements = ", ".join(f"{count} {name}" for name, count in made["elements"].items())
    cases = len(made["load_cases"])
    return (
        f"{made['nodes']} nodes in {made['dimension']} dimension(s), {elements}; "
        f"{made['displacements']} displacements, {made['prescribed']} of them prescribed; "
        f"{cases} load case(s)"
    )


def messages(model: StructuralModel) -> list[tuple[str, str]]:
    """(level, text) of what is doubtful about it: nothing, what is wrong is an error."""
    return []


def explain(model: StructuralModel) -> None:
    """Print all that is known of it."""
    made = description(model)
    head(model.name, sentence(model))
    for name, count in made["elements"].items():
        tell(f"  elements        {count:>6}  {name}")
    for case in made["load_cases"]:
        tell(f"  load case       {case or '(without a name)'}")
    print_parameters(model)


def write(
    result: StructuralOutputs, base: Path, report: bool, csv: bool, choices: Any = None
) -> list[Path]:
    """Results (.nc), and if asked for a table (.csv) and a report (.report.html)."""
    files = [result.save(base.with_name(f"{base.name}.nc"))]
    if csv:
        files.append(result.to_csv(base.with_name(f"{base.name}.csv")))
    if report:
        files.append(result.report(base.with_name(f"{base.name}.report.html")))
    return files


def summary(result: StructuralOutputs) -> dict[str, Any]:
    """Status, and the largest displacement and the sum of the reactions of each state."""
    made: dict[str, Any] = {
        "status": str(result.status),
        "residual": result.status.residual,
        "statistics": result.statistics,
    }
    named = getattr(result, "named", {})
    numbers = {name: result.values(name) for name in named}
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


def _largest(result: StructuralOutputs, k: int) -> dict[str, Any]:
    """Size and node of the largest displacement."""
    degrees = result.model.degrees
    table = degrees.table[:, : degrees.dimension]
    size = np.linalg.norm(np.where(table >= 0, result.displacements[table, k], 0.0), axis=1)
    node = int(np.argmax(size))
    return {"value": float(size[node]), "unit": "m", "node": degrees.nodes.name(node)}


def _reactions(result: StructuralOutputs, k: int) -> dict[str, float]:
    """Sum of the forces of the supports along each direction [N]."""
    degrees, held = result.model.degrees, result.model.assembly.prescribed
    found = {}
    for axis, direction in enumerate(degrees.directions[: degrees.dimension]):
        numbers = np.intersect1d(degrees.table[:, axis], held)
        found[direction.replace("u", "f", 1)] = float(result.forces[numbers, k].sum())
    return found


def show(made: dict[str, Any]) -> None:
    """Print the states as a table."""
    from rich import box
    from rich.table import Table

    rows = made.get("states", [])
    if not rows:
        return
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, collapse_padding=True)
    for k, heading in enumerate(rows[0]):
        table.add_column(heading.replace("_", " "), justify="right" if k else "left", no_wrap=True)
    for row in rows[:SHOWN]:
        table.add_row(*(_cell(value) for value in row.values()))
    out = console()
    out.print(table)
    if len(rows) > SHOWN:
        tell(f"  … and {len(rows) - SHOWN} more in the result file")


def _cell(value: Any) -> str:
    if isinstance(value, dict) and "node" in value:
        return f"{value['value']:.6g} {value['unit']} at {value['node']}"
    if isinstance(value, dict):
        largest = max((abs(v) for v in value.values()), default=0.0)
        parts = (f"{k} {0.0 if abs(v) < 1e-10 * largest else v:.6g}" for k, v in value.items())
        return ", ".join(parts) + " N"
    return shown(value)
