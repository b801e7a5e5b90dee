"""Every scalar quantity of a motion under the name of its measure, as pages and tables show it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.results.labelled import DATA_ONLY, LabelledRecording
from dalembert.symbolic.formulas.expression import Expression

if TYPE_CHECKING:
    import pandas as pd

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


def measured_series(motion: LabelledRecording, keep: np.ndarray) -> list[dict[str, Any]]:
    """All scalar quantities by their measure names, with unit, group and values at some outputs."""
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


def series_table(motion: LabelledRecording, measures: Sequence[str | Expression]) -> pd.DataFrame:
    """Measures as columns, all scalar ones where none are named; units in ``attrs``."""
    import pandas as pd

    columns, units = {}, {}
    if not measures:
        for one in measured_series(motion, np.arange(motion.time.size)):
            columns[one["name"]], units[one["name"]] = one["values"], one["unit"]
    for measure in measures:
        found = motion[measure]
        unit = str(found.attrs.get("units", ""))
        axes = found.values[:, None] if found.ndim == 1 else found.values
        labels = [""] if found.ndim == 1 else [f".{a}" for a in found.coords[found.dims[1]].values]
        for k, label in enumerate(labels):
            columns[f"{found.name}{label}"], units[f"{found.name}{label}"] = axes[:, k], unit
    table = pd.DataFrame(columns, index=pd.Index(motion.time, name="time"))
    table.attrs["units"] = units
    return table
