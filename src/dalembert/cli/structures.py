"""What the commands write and tell of a structure's results."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dalembert.cli.console import console, head, shown, tell
from dalembert.cli.parameters import parameters, print_parameters

if TYPE_CHECKING:
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
