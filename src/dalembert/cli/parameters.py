"""The parameters of a model as the commands tell them."""

from __future__ import annotations

from typing import Any

from dalembert.cli.console import tell


def parameters(model: Any) -> dict[str, dict[str, Any]]:
    """Name → value, unit, bounds and description."""
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
    """One line for each."""
    for name, p in model.parameters.items():
        low, high = p.bounds
        bounds = "" if low == -high == float("-inf") else f"  in [{low:g}, {high:g}]"
        about = f"  {p.description}" if p.description else ""
        tell(f"  parameter       {name} = {p.value:g} {p.unit}{bounds}{about}")
