"""What the commands write and tell of a mechanism and its results."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dalembert.cli.console import head, shown, tell
from dalembert.cli.parameters import parameters, print_parameters

if TYPE_CHECKING:
    from dalembert.model.model import Model


def description(model: Model) -> dict[str, Any]:
    """The diagnosis with parameters and derived values."""
    return {
        "diagnosis": model.diagnosis.to_dict(),
        "parameters": parameters(model),
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


def sentence(model: Model) -> str:
    """What it is, in one line."""
    return model.diagnosis.summary


def messages(model: Model) -> list[tuple[str, str]]:
    """(level, text) of what is doubtful about it."""
    return model.diagnosis.messages


def explain(model: Model) -> None:
    """Print all that is known of it."""
    d = model.diagnosis
    head(model.name, d.summary)
    count = f"{d.coordinates} coordinates − {d.joint_equations} joint equations = {d.gruebler}"
    note = (
        "" if d.gruebler == d.degrees_of_freedom else " (redundant equations make the difference)"
    )
    tell(f"  Grübler count  {count}{note}")
    for title, names in (
        ("bodies", d.bodies),
        ("joints", d.joints),
        ("drivers", d.drivers),
        ("forces", d.forces),
    ):
        if names:
            tell(f"  {title:<9} {len(names):>4}  {', '.join(names)}")
    for loop in d.topology.loops:
        tell(f"  loop            {' → '.join(loop)}")
    print_parameters(model)
    for name, entry in derived_values(model).items():
        tell(f"  derived         {name} = {entry['value']:g} {entry['unit']}")
    for level, text in d.messages:
        tell(f"  {level}: {text}", "yellow" if level == "warning" else None)


def show(made: dict[str, Any]) -> None:
    """Print a summary."""
    pairs = made.get("final", {}) | made.get("largest", {})
    for name, value in pairs.items():
        tell(f"  {name.replace('_', ' '):<24} {shown(value)}")
    for event in made.get("events", [])[:20]:
        tell(f"  event {event['name']} at t = {event['time']:.9g} s")
    for number, mode in enumerate(made.get("modes", []), 1):
        listed = ", ".join(f"{name} {value:.6g}" for name, value in mode.items())
        tell(f"  mode {number}: {listed}")
