"""What the commands write and tell of a mechanism and its results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import head, shown, tell
from dalembert.cli.parameters import parameters, print_parameters
from dalembert.results.motion import Motion

if TYPE_CHECKING:
    from dalembert.model.model import Model
    from dalembert.results.mechanism_modes import Modes


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


def write(result: Any, base: Path, report: bool, csv: bool, choices: dict) -> list[Path]:
    """Results (.nc), and if asked for a table (.csv) and a report (.report.html)."""
    return (
        _write_motion(result, base, report, csv, choices)
        if isinstance(result, Motion)
        else _write_modes(result, base, csv)
    )


def _write_motion(motion: Motion, base: Path, report: bool, csv: bool, choices: dict) -> list[Path]:
    files = [motion.save(base.with_name(f"{base.name}.nc"))]
    if csv:
        files.append(motion.to_csv(base.with_name(f"{base.name}.csv")))
    if report:
        files.append(motion.report(base.with_name(f"{base.name}.report.html"), **choices))
    return files


def _write_modes(modes: Modes, base: Path, csv: bool) -> list[Path]:
    from dalembert.atomic import atomic_path
    from dalembert.results.store import save_dataset

    files = [save_dataset(modes.data, base.with_name(f"{base.name}.nc"))]
    if csv:
        table = base.with_name(f"{base.name}.csv")
        with atomic_path(table) as temporary:
            modes.data[["frequency", "damping_ratio"]].to_dataframe().to_csv(temporary)
        files.append(table)
    return files


def summary(result: Any) -> dict[str, Any]:
    """Status and the numbers to tell."""
    return _motion_summary(result) if isinstance(result, Motion) else _modes_summary(result)


def _motion_summary(motion: Motion) -> dict[str, Any]:
    last: dict[str, Any] = {}
    for name in ("kinetic_energy", "potential_energy", "energy", "balance_error"):
        if name in motion.data and motion.time.size:
            last[name] = float(motion.data[name][-1])
    worst = {
        name: float(motion.data[name].max())
        for name in ("position_violation", "velocity_violation")
        if name in motion.data and motion.time.size
    }
    return {
        "status": str(motion.status),
        "time": motion.status.time,
        "residual": motion.status.residual,
        "statistics": motion.statistics,
        "warnings": list(motion.warnings),
        "events": [event.row for event in motion.events],
        "final": last,
        "largest": worst,
    }


def _modes_summary(modes: Modes) -> dict[str, Any]:
    found = zip(modes.frequencies, modes.damping_ratios, strict=True)
    return {
        "status": f"{'stable' if modes.stable else 'not stable'}, {modes.eigenvalues.size} mode(s)",
        "modes": [{"frequency [Hz]": float(f), "damping ratio": float(z)} for f, z in found],
    }


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
