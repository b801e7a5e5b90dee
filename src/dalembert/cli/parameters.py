"""The parameters of a model as the commands tell them."""

from __future__ import annotations

from typing import Any

from dalembert.cli.console import tell


def parameters(model: Any) -> dict[str, dict[str, Any]]:
    """Name → value, unit, bounds and description, in SI units."""
    return {
        name: {
            "value": p.value,
            "unit": p.unit,
            "bounds": p.bounds,
            "description": p.description,
        }
        for name, p in model.parameters.items()
    }


def print_parameters(model: Any) -> None:
    """One line for each, in the unit that it was given in."""
    for name, p in model.parameters.items():
        low, high = map(p.shown, p.bounds)
        unit = p.given_unit or p.unit
        bounds = "" if low == -high == float("-inf") else f"  in [{low:g}, {high:g}]"
        about = f"  {p.description}" if p.description else ""
        tell(f"  parameter       {name} = {p.shown(p.value):g} {unit}{bounds}{about}")
