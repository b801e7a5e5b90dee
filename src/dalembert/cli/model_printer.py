"""Text and JSON output of mechanisms, structures and their results."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Generic, TypeVar

from dalembert.cli.console import format_value, print_heading, print_line, print_table
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.model import Model

MAX_ROWS = 20
"""Upper limit of rows of a printed table."""

M = TypeVar("M")


class ModelPrinter(ABC, Generic[M]):
    """Output of a model and its results, as text and for JSON.

    Parameters
    ----------
    model : Model or StructuralModel
    """

    def __init__(self, model: M):
        self.model = model

    @property
    @abstractmethod
    def description(self) -> dict[str, Any]:
        """Contents of the model, for JSON."""

    @property
    @abstractmethod
    def sentence(self) -> str:
        """Summary of the model in one line."""

    @property
    def messages(self) -> list[tuple[str, str]]:
        """(level, text) of notes and warnings about the model."""
        return []

    @abstractmethod
    def explain(self) -> None:
        """Print the description of the model."""

    def show(self, summary: dict[str, Any]) -> None:
        """Print energies, extremes, events and states of a result."""
        energies = {f"{name} [J]": value for name, value in summary.get("final", {}).items()}
        for name, value in (energies | summary.get("largest", {})).items():
            print_line(f"  {name.replace('_', ' '):<24} {format_value(value)}")
        for event in summary.get("events", [])[:20]:
            print_line(f"  event {event['name']} at t = {event['time']:.9g} s")
        if rows := summary.get("states", []):
            _print_states(rows)


class MechanismPrinter(ModelPrinter[Model]):
    """Output of a mechanism and its results."""

    @property
    def description(self) -> dict[str, Any]:
        """The diagnosis with parameters and derived values."""
        return {
            "diagnosis": self.model.diagnosis.to_dict(),
            "parameters": _parameters(self.model),
            "inputs": list(self.model.inputs),
            "outputs": _outputs(self.model),
            "derived": self.derived_values,
        }

    @property
    def derived_values(self) -> dict[str, dict[str, Any]]:
        """Values of the derived parameters at the nominal parameters."""
        import casadi as ca

        derived = self.model.derived_parameters
        if not derived:
            return {}
        formulas = ca.vertcat(*(d.sx for d in derived.values()))
        function = ca.Function("derived", [self.model.equations.p], [formulas])
        values = function(self.model.nominal).full().ravel()
        return {
            name: {"value": float(value), "unit": d.unit}
            for (name, d), value in zip(derived.items(), values, strict=True)
        }

    @property
    def sentence(self) -> str:
        """Summary of the mechanism in one line."""
        return self.model.diagnosis.summary

    @property
    def messages(self) -> list[tuple[str, str]]:
        """(level, text) of notes and warnings of the diagnosis."""
        return self.model.diagnosis.messages

    def explain(self) -> None:
        """Print the diagnosis, parameters and derived values."""
        d = self.model.diagnosis
        print_heading(self.model.name, d.summary)
        count = f"{d.coordinates} coordinates − {d.joint_equations} joint equations = {d.gruebler}"
        redundant = d.gruebler != d.degrees_of_freedom
        note = " (redundant equations make the difference)" if redundant else ""
        print_line(f"  Grübler count  {count}{note}")
        for title, names in (
            ("bodies", d.bodies),
            ("joints", d.joints),
            ("drivers", d.drivers),
            ("forces", d.forces),
        ):
            if names:
                print_line(f"  {title:<9} {len(names):>4}  {', '.join(names)}")
        for loop in d.topology.loops:
            print_line(f"  loop            {' → '.join(loop)}")
        _print_parameters(self.model)
        for name, entry in self.derived_values.items():
            print_line(f"  derived         {name} = {entry['value']:g} {entry['unit']}")
        for level, text in d.messages:
            print_line(f"  {level}: {text}", "yellow" if level == "warning" else None)


class StructurePrinter(ModelPrinter[StructuralModel]):
    """Output of a structure and its results."""

    @property
    def description(self) -> dict[str, Any]:
        """Contents of the structure, and its parameters."""
        return {
            "dimension": self.model.degrees.dimension,
            "nodes": len(self.model.degrees.nodes),
            "elements": {block.kind.cls.__name__: block.count for block in self.model.blocks},
            "displacements": len(self.model.degrees),
            "prescribed": len(self.model.supports),
            "load_cases": list(self.model.loads),
            "parameters": _parameters(self.model),
            "inputs": list(self.model.inputs),
            "outputs": _outputs(self.model),
        }

    @property
    def sentence(self) -> str:
        """Summary of the structure in one line."""
        description = self.description
        elements = ", ".join(f"{count} {name}" for name, count in description["elements"].items())
        cases = len(description["load_cases"])
        return (
            f"{description['nodes']} nodes in {description['dimension']} dimension(s), {elements}; "
            f"{description['displacements']} displacements, "
            f"{description['prescribed']} of them prescribed; "
            f"{cases} load case(s)"
        )

    def explain(self) -> None:
        """Print the elements, load cases and parameters."""
        description = self.description
        print_heading(self.model.name, self.sentence)
        for name, count in description["elements"].items():
            print_line(f"  elements        {count:>6}  {name}")
        for case in description["load_cases"]:
            print_line(f"  load case       {case or '(without a name)'}")
        _print_parameters(self.model)


def _print_states(rows: list[dict[str, Any]]) -> None:
    """Print load cases, instants or modes as a table."""
    headings = [heading.replace("_", " ") for heading in rows[0]]
    print_table(headings, [list(map(_cell, row.values())) for row in rows[:MAX_ROWS]])
    if len(rows) > MAX_ROWS:
        print_line(f"  … and {len(rows) - MAX_ROWS} more in the result file")


def _cell(value: Any) -> str:
    if isinstance(value, dict) and "node" in value:
        return f"{value['value']:.6g} {value['unit']} at {value['node']}"
    if isinstance(value, dict):
        largest = max((abs(v) for v in value.values()), default=0.0)
        parts = (f"{k} {0.0 if abs(v) < 1e-10 * largest else v:.6g}" for k, v in value.items())
        return ", ".join(parts) + " N"
    return format_value(value)


def _parameters(model: Any) -> dict[str, dict[str, Any]]:
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


def _outputs(model: Any) -> dict[str, dict[str, str]]:
    """Name → unit and description of the outputs."""
    return {
        name: {"unit": model.outputs[name].unit, "description": output.description}
        for name, output in model.declared_outputs.items()
    }


def _print_parameters(model: Any) -> None:
    """Print a line for each parameter, in the unit of its declaration."""
    for name, p in model.parameters.items():
        low, high = map(p.in_declared_unit, p.bounds)
        unit = p.declared_unit or p.unit
        bounds = "" if low == -high == float("-inf") else f"  in [{low:g}, {high:g}]"
        about = f"  {p.description}" if p.description else ""
        print_line(f"  {p.role:<15} {name} = {p.in_declared_unit(p.value):g} {unit}{bounds}{about}")
    for name, output in model.declared_outputs.items():
        about = f"  {output.description}" if output.description else ""
        print_line(f"  output          {name} {model.outputs[name].unit}{about}")
