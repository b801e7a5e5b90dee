"""What the report shows, as plain data: drawing, series, diagnosis, statistics."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.labelled import DATA_ONLY, LabelledRecording
from dalembert.results.page_parts import diagnosis, parameter_rows, statistics
from dalembert.results.scene import is_spatial, motion_scene

MAX_FRAMES = 20_000
MAX_NUMBERS = 6_000_000
"""Of all series of a page together; of a large mechanism fewer instants are shown."""
LEAST_FRAMES = 2000


def report_payload(
    motion: LabelledRecording,
    plots: Sequence[Sequence[str]] | None,
    trace: Sequence[str] | None,
) -> dict[str, Any]:
    """Everything the page needs, thinned to at most ``MAX_FRAMES`` instants, fewer where many move.

    Parameters
    ----------
    plots : groups of series names, one plot each; a sensible choice if None
    trace : names of points whose paths are drawn from the start
    """
    count = motion.time.size
    keep = np.unique(np.linspace(0, count - 1, min(count, _frames(motion))).round().astype(int))
    series = _series(motion, keep)
    names = {s["name"] for s in series}
    for name in dict.fromkeys(n for group in plots or () for n in group if n not in names):
        series.append(_asked(motion, name, keep))
        names.add(name)
    wanted = [list(group) for group in plots] if plots else None
    payload = {
        "format": 1,
        "kind": "spatial" if is_spatial(motion.model) else "mechanism",
        "title": motion.model.name,
        "subtitle": _subtitle(motion),
        "time": motion.time[keep].tolist() if count else [],
        "scene": motion_scene(motion, keep),
        "series": series,
        "default_plots": [g for g in wanted if g] if wanted else _default_plots(motion, names),
        "events": [event.row for event in motion.events],
        "diagnosis": _diagnosis(motion),
        "statistics": _statistics(motion),
        "parameters": parameter_rows(motion.model.parameters, motion.parameters),
    }
    if trace is not None:
        payload["trace"] = list(trace)
        payload["scene"]["points"].sort(key=lambda point: point["name"] not in trace)
    return payload


def _frames(motion: LabelledRecording) -> int:
    """How many instants a page shows at most."""
    columns = sum(v.size for v in motion.data.data_vars.values()) / max(1, motion.time.size)
    return int(np.clip(MAX_NUMBERS / max(1.0, columns), LEAST_FRAMES, MAX_FRAMES))


def _subtitle(motion: LabelledRecording) -> str:
    choices = ("integrator", "formulation", "stabilization", "coordinates")
    used = [str(motion.statistics[k]) for k in choices if k in motion.statistics]
    told = " + ".join(u for u in used if u != "AbsoluteCoordinates")
    return ", ".join([motion.analysis.spoken, told]).rstrip(", ")


def _series(motion: LabelledRecording, keep: np.ndarray) -> list[dict[str, Any]]:
    """All scalar quantities by their measure names, grouped for the picker."""
    data = motion.contents
    found: list[dict[str, Any]] = []

    def put(name: str, variable: str, group: str, **where: Any) -> None:
        if variable in data:
            unit = _unit(motion, str(data.about(variable).get("units", "")), name)
            add(name, unit, group, data.at(variable, **where)[keep])

    def add(name: str, unit: str, group: str, values: np.ndarray) -> None:
        if not np.all(np.isnan(values)):
            found.append({"name": name, "unit": unit, "group": group, "values": values})

    def put_all(owner: str, quantity: str, variable: str, group: str, **where: Any) -> None:
        """One of a scalar, one for each axis of a vector."""
        if variable not in data:
            return
        for axis in data.labels("axis") if "axis" in data.dimensions(variable) else [None]:
            along = where | ({} if axis is None else {"axis": axis})
            put(f"{owner}.{quantity.format(axis or '')}".rstrip("."), variable, group, **along)

    turning = {body.name for body in motion.model.bodies if body.rotates}
    for body in data.labels("body"):
        for quantity, variable, group in BODY_SERIES:
            if body not in turning and variable.startswith("ang"):
                continue
            put_all(body, quantity, variable, group, body=body)
    for point in data.labels("point"):
        for quantity, variable in POINT_SERIES:
            put_all(point, quantity, variable, "points", point=point)
    for joint in data.labels("joint"):
        put_all(joint, "force.{}", "reaction_force", "reactions", joint=joint)
        force = data.at("reaction_force", joint=joint)[keep]
        add(f"{joint}.force_norm", "N", "reactions", np.linalg.norm(force, axis=1))
        put_all(joint, "moment.{}", "reaction_moment", "reactions", joint=joint)
    for driver in data.labels("driver"):
        put(f"{driver}.effort", "driver_effort", "drivers", driver=driver)
        put(f"{driver}.power", "driver_power", "drivers", driver=driver)
    for variable in data.variables:
        if variable.startswith("element_"):
            dimension = data.dimensions(variable)[1]
            quantity = variable.removeprefix("element_").split("_of")[0]
            for element in data.labels(dimension):
                put(f"{element}.{quantity}", variable, "forces", **{dimension: element})
    for variable in ENERGIES:
        put(variable, variable, "energy")
    for variable in ("position_violation", "velocity_violation"):
        put(variable, variable, "violations")
    return found


def _unit(motion: LabelledRecording, unit: str, name: str) -> str:
    """The unit of one series; a variable may hold forces and moments side by side."""
    mixed = " or " in unit and name not in DATA_ONLY
    return motion.model[name].unit if mixed else unit


def _asked(motion: LabelledRecording, name: str, keep: np.ndarray) -> dict[str, Any]:
    """A measure or formula that is not among the usual series.

    Raises
    ------
    AnalysisError
        It is a vector.
    """
    measure = motion[name]
    if measure.ndim != 1:
        raise AnalysisError(
            f"plot {name!r}: the measure has {measure.shape[1]} components; take one"
        )
    return {
        "name": name,
        "unit": str(measure.attrs.get("units", "")),
        "group": "formulas",
        "values": measure.values[keep],
    }


BODY_SERIES = (
    ("{}", "position", "position"),
    ("angle", "angle", "position"),
    ("v{}", "velocity", "velocity"),
    ("angular_velocity.{}", "angular_velocity", "velocity"),
    ("a{}", "acceleration", "acceleration"),
    ("angular_acceleration.{}", "angular_acceleration", "acceleration"),
)
"""Name of a quantity, with the axis if it is a vector; its variable; its group."""
POINT_SERIES = (("{}", "point_position"), ("v{}", "point_velocity"), ("a{}", "point_acceleration"))
ENERGIES = (
    "kinetic_energy",
    "potential_energy",
    "energy",
    "dissipated_energy",
    "input_energy",
    "balance_error",
)


def _default_plots(motion: LabelledRecording, names: set[str]) -> list[list[str]]:
    diagnosis = motion.model.diagnosis
    angles = [f"{b.name}.angle" for b in motion.model.bodies]
    turning = [f"{b}.angular_velocity.{axis}" for b in diagnosis.bodies[:1] for axis in "xyz"]
    places = [f"{b}.{c}" for b in diagnosis.bodies[:2] for c in "xyz"]
    choices = ([n for n in some if n in names][:4] for some in (angles, turning, places))
    angles = next((some for some in choices if some), [])
    plots = [angles]
    efforts = [f"{d}.effort" for d in diagnosis.drivers if f"{d}.effort" in names]
    reactions = [f"{j}.force_norm" for j in diagnosis.joints[:4] if f"{j}.force_norm" in names]
    if efforts:
        plots.append(efforts[:2])
    if reactions:
        plots.append(reactions)
    if motion.analysis.integrates:
        plots.append([e for e in ("kinetic_energy", "potential_energy", "energy") if e in names])
    return plots


def _diagnosis(motion: LabelledRecording) -> dict[str, Any]:
    d = motion.model.diagnosis
    items = [
        ("degrees of freedom", d.degrees_of_freedom),
        ("Grübler's count", d.gruebler),
        ("bodies", len(d.bodies)),
        ("joints", len(d.joints)),
        ("drivers", len(d.drivers)),
        ("joint equations", d.joint_equations),
        ("redundant equations", len(d.redundancies)),
        ("loops", "; ".join("–".join(loop) for loop in d.topology.loops) or "none"),
    ]
    doubts = [("warning", text) for text in motion.warnings]
    return diagnosis(d.summary, items, [*doubts, *d.messages], motion.status)


def _statistics(motion: LabelledRecording) -> list[dict[str, str]]:
    rows = [("status", motion.status.outcome.value), *motion.statistics.items()]
    data = motion.contents
    for name, label in (
        ("position_violation", "largest position violation"),
        ("velocity_violation", "largest velocity violation"),
    ):
        if data[name].size:
            rows.append((label, f"{float(data[name].max()):.3g}"))
    error = np.abs(data["balance_error"])
    if error.size and np.isfinite(error).all():
        rows.append(("largest energy balance error [J]", f"{error.max():.3g}"))
    return statistics(rows)
