"""``dalembert check``: explain a model without solving anything."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import DONE, AsJson, Settings, console, emit, wrong_input
from dalembert.cli.loading import loaded

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile
    from dalembert.model.model import Model


def check(model: Path, /, *, settings: Settings | None = None, as_json: AsJson = False) -> int:
    """Explain a model: its freedom, parts, parameters, and what is doubtful about it.

    Nothing is simulated. The mechanism is assembled, so that wrong lengths show here.

    Parameters
    ----------
    model
        Model file, TOML or JSON.
    settings
        New value of a parameter, name=value; repeatable.
    as_json
        Print one JSON document instead of text.
    """
    file, built = loaded(model, settings)
    with wrong_input():
        _check_tasks(file, built)
    if as_json:
        emit({"ok": True, "name": file.name, **description(built)})
    else:
        _print(built)
    return DONE


def _check_tasks(file: ModelFile, model: Model) -> None:
    """What the file asks to compute can be made."""
    from dalembert.io.tasks import check_tasks

    check_tasks(file, model)


def description(model: Model) -> dict[str, Any]:
    """The diagnosis with parameters and derived values."""
    return {
        "diagnosis": model.diagnosis.to_dict(),
        "parameters": {
            name: {
                "value": p.value,
                "unit": p.unit,
                "bounds": p.bounds,
                "description": p.description,
            }
            for name, p in model.parameters.items()
        },
        "derived": derived_values(model),
    }


def derived_values(model: Model) -> dict[str, dict[str, Any]]:
    """Values of the derived parameters at the nominal ones."""
    import casadi as ca

    made = model.derived_parameters
    if not made:
        return {}
    formulas = ca.vertcat(*(d.sx for d in made.values()))
    values = ca.Function("derived", [model.equations.p], [formulas])(model.nominal).full().ravel()
    return {
        name: {"value": float(value), "unit": d.unit}
        for (name, d), value in zip(made.items(), values, strict=True)
    }


def _print(model: Model) -> None:
    out, d = console(), model.diagnosis
    out.print(f"[bold]{model.name}[/bold]: {d.summary}", markup=True)
    count = f"{d.coordinates} coordinates − {d.joint_equations} joint equations = {d.gruebler}"
    note = (
        "" if d.gruebler == d.degrees_of_freedom else " (redundant equations make the difference)"
    )
    out.print(f"  Grübler count  {count}{note}")
    for title, names in (
        ("bodies", d.bodies),
        ("joints", d.joints),
        ("drivers", d.drivers),
        ("forces", d.forces),
    ):
        if names:
            out.print(f"  {title:<9} {len(names):>4}  {', '.join(names)}", markup=False)
    for loop in d.topology.loops:
        out.print(f"  loop            {' → '.join(loop)}", markup=False)
    for name, p in model.parameters.items():
        low, high = p.bounds
        bounds = "" if low == -high == float("-inf") else f"  in [{low:g}, {high:g}]"
        about = f"  {p.description}" if p.description else ""
        out.print(f"  parameter       {name} = {p.value:g} {p.unit}{bounds}{about}", markup=False)
    for name, entry in derived_values(model).items():
        out.print(f"  derived         {name} = {entry['value']:g} {entry['unit']}", markup=False)
    for level, text in d.messages:
        out.print(
            f"  {level}: {text}", markup=False, style="yellow" if level == "warning" else None
        )
