"""Labelled measures of a motion: arrays, series of scalars and tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from dalembert.results.files.contents import COMPONENTS, Contents
from dalembert.results.recording import Recording
from dalembert.results.sources import Series, Source
from dalembert.symbolic.formulas.expression import Expression

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from dalembert.results.contact_forces import ContactForces

DATA_ONLY = {
    "energy",
    "dissipated_energy",
    "input_energy",
    "balance_error",
    "position_violation",
    "velocity_violation",
}


@dataclass(eq=False, repr=False)
class LabelledRecording(Recording):
    """Recording whose quantities are labelled arrays."""

    def __getitem__(self, measure: str | Expression) -> xr.DataArray:
        """A measure by name, or a formula of measures, as a labelled array over time.

        Raises
        ------
        KeyError
            Unknown name; suggests the nearest ones.
        """
        if isinstance(measure, str) and measure in DATA_ONLY:
            return self.data[measure]
        expression = self.expression(measure)
        coords: dict[str, Any] = {"time": ("time", self.time, {"units": "s"})}
        if len(expression) > 1:
            dimension, names = COMPONENTS[len(expression)]
            coords[dimension] = list(names)
        return self.labelled(measure, coords)

    def drawn_contacts(self, row: int) -> ContactForces | None:
        """Contacts at an output, for pictures; None for motions without a record of contacts."""
        return None

    def __contains__(self, measure: object) -> bool:
        return (isinstance(measure, str) and measure in DATA_ONLY) or super().__contains__(measure)

    def keys(self) -> list[str]:
        return list(dict.fromkeys([*super().keys(), *sorted(DATA_ONLY)]))

    @cached_property
    def contents(self) -> Contents:
        """Poses, speeds, reactions, efforts, energies and violations."""
        from dalembert.results.dataset import motion_contents

        return motion_contents(self)

    @property
    def data(self) -> xr.Dataset:
        """Labelled dataset of the motion; its attribute ``warnings`` has those known so far.

        Reading ``warnings`` of the motion completes them by checks that take up to two more runs;
        until then, a last line says so.
        """
        data = super().data
        data.attrs["warnings"] = "\n".join([*self._noted_warnings, *self._missing_warnings])
        return data

    def saved_contents(self) -> Contents:
        attributes = self.contents.attributes | {"warnings": "\n".join(self.warnings)}
        return replace(self.contents, attributes=attributes)

    def source(self, variable: str, **labels: str) -> Source | None:
        """Formula of a variable of ``contents`` at labels of its dimensions, if it has one."""
        from dalembert.results.variables import variable_source

        return variable_source(self.model, variable, **labels)


BODY_SERIES = (
    ("{}", "position", "position"),
    ("angle", "angle", "position"),
    ("v{}", "velocity", "velocity"),
    ("angular_velocity.{}", "angular_velocity", "velocity"),
    ("a{}", "acceleration", "acceleration"),
    ("angular_acceleration.{}", "angular_acceleration", "acceleration"),
)
"""Name of a quantity (``{}`` is the axis of a vector), its variable and its group."""
POINT_SERIES = (("{}", "point_position"), ("v{}", "point_velocity"), ("a{}", "point_acceleration"))
ENERGIES = (
    "kinetic_energy",
    "potential_energy",
    "energy",
    "dissipated_energy",
    "input_energy",
    "balance_error",
)


def measured_series(motion: LabelledRecording, keep: np.ndarray) -> list[Series]:
    """All scalar quantities by their measure names, with unit, group and values at some outputs."""
    data = motion.contents
    series: list[Series] = []

    def put(name: str, variable: str, group: str, **where: Any) -> None:
        if variable in data:
            unit = _unit(motion, str(data.attributes_of(variable).get("units", "")), name)
            values = data.at(variable, **where)[keep]
            add(name, unit, group, values, motion.source(variable, **where))

    def add(name: str, unit: str, group: str, values: np.ndarray, source: Source | None) -> None:
        if not np.all(np.isnan(values)):
            series.append(Series(source, name=name, unit=unit, group=group, values=values))

    def put_all(owner: str, quantity: str, variable: str, group: str, **where: Any) -> None:
        """Add a scalar, or one series for each axis of a vector."""
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
        norm = np.linalg.norm(data.at("reaction_force", joint=joint)[keep], axis=1)
        formula = _norm(motion.source("reaction_force", joint=joint))
        add(f"{joint}.force_norm", "N", "reactions", norm, formula)
        put_all(joint, "moment.{}", "reaction_moment", "reactions", joint=joint)
    for driver in data.labels("driver"):
        put(f"{driver}.effort", "effort", "drivers", driver=driver)
        put(f"{driver}.power", "power", "drivers", driver=driver)
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
    return series


def _norm(vector: Source | None) -> Source | None:
    """Formula of the norm of a vector."""
    return ca.sqrt(ca.sumsqr(vector)) if isinstance(vector, ca.SX) else None


def _unit(motion: LabelledRecording, unit: str, name: str) -> str:
    """The unit of one series; a variable may hold forces and moments side by side."""
    mixed = " or " in unit and name not in DATA_ONLY
    return motion.model[name].unit if mixed else unit


def series_table(motion: LabelledRecording, measures: Sequence[str | Expression]) -> pd.DataFrame:
    """Measures as columns, by default all scalar ones; units in ``attrs``."""
    import pandas as pd

    columns, units = {}, {}
    if not measures:
        for entry in measured_series(motion, np.arange(motion.time.size)):
            columns[entry["name"]], units[entry["name"]] = entry["values"], entry["unit"]
    for measure in measures:
        array = motion[measure]
        unit = str(array.attrs.get("units", ""))
        axes = array.values[:, None] if array.ndim == 1 else array.values
        labels = [""] if array.ndim == 1 else [f".{a}" for a in array.coords[array.dims[1]].values]
        for k, label in enumerate(labels):
            columns[f"{array.name}{label}"], units[f"{array.name}{label}"] = axes[:, k], unit
    table = pd.DataFrame(columns, index=pd.Index(motion.time, name="time"))
    table.attrs["units"] = units
    return table
