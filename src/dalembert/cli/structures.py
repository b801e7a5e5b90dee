"""What the commands write and tell of a structure's results."""

from __future__ import annotations

from typing import Any

from dalembert.cli.console import console, head, shown, tell
from dalembert.cli.parameters import parameters, print_parameters
from dalembert.cli.teller import Teller
from dalembert.structures.model import StructuralModel

SHOWN = 20
"""Rows of a table that are printed."""


class StructureTeller(Teller[StructuralModel]):
    """A structure and its results."""

    @property
    def description(self) -> dict[str, Any]:
        """What a structure consists of, and its parameters."""
        return {
            "dimension": self.model.degrees.dimension,
            "nodes": len(self.model.degrees.nodes),
            "elements": {block.kind.cls.__name__: block.count for block in self.model.blocks},
            "displacements": len(self.model.degrees),
            "prescribed": len(self.model.supports),
            "load_cases": list(self.model.loads),
            "parameters": parameters(self.model),
        }

    @property
    def sentence(self) -> str:
        """The same in one line."""
        made = self.description
        elements = ", ".join(f"{count} {name}" for name, count in made["elements"].items())
        cases = len(made["load_cases"])
        return (
            f"{made['nodes']} nodes in {made['dimension']} dimension(s), {elements}; "
            f"{made['displacements']} displacements, {made['prescribed']} of them prescribed; "
            f"{cases} load case(s)"
        )

    def explain(self) -> None:
        """Print all that is known of it."""
        made = self.description
        head(self.model.name, self.sentence)
        for name, count in made["elements"].items():
            tell(f"  elements        {count:>6}  {name}")
        for case in made["load_cases"]:
            tell(f"  load case       {case or '(without a name)'}")
        print_parameters(self.model)

    def show(self, made: dict[str, Any]) -> None:
        """Print the states as a table."""
        from rich import box
        from rich.table import Table

        rows = made.get("states", [])
        if not rows:
            return
        table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, collapse_padding=True)
        for k, heading in enumerate(rows[0]):
            side: Any = "right" if k else "left"
            table.add_column(heading.replace("_", " "), justify=side, no_wrap=True)
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
